"""Jobs: what is to run, what runs, and the words that change it."""

from collections.abc import Callable, Mapping
from typing import Any

from app.agents import registry
from app.domain.errors import InvalidInput
from app.services.bus import EventBus
from app.services.crew import Crew
from app.services.entries import Entry, RaceStart, TrainingStart, race_entries, training_entry
from app.services.errors import Conflict
from app.services.experiment_entry import ExperimentStart, experiment_entry
from app.services.ids import RunIds
from app.services.job import Job
from app.services.recordings import Recordings
from app.services.resuming import resumed_entries
from app.services.store import LIVE, PAUSED, RESUMABLE, RUNNING, TABLE, Run, RunStore, State
from app.services.views import run_view
from app.services.waiting import WaitingRuns

MAX_PAUSED = 16
_ANSWER_S = 5.0
_DIE_S = 2.0


class Jobs:
    """Starts runs in order, as many at once as there are cores, and tells them what to do.

    Every verb may be called from any thread. A paused job needs no core and gives its place away.
    """

    def __init__(
        self,
        store: RunStore,
        recordings: Recordings,
        bus: EventBus,
        on_queued: Callable[[str], object] | None = None,
        cores: int | None = None,
    ) -> None:
        """Start nothing yet.

        Args:
            store: where runs are kept.
            recordings: where their motion goes.
            bus: who wants to know.
            on_queued: called with the id of what someone has asked for.
            cores: how many jobs run at once; the machine's by default.
        """
        self._store, self._recordings, self._bus = store, recordings, bus
        self._on_queued = on_queued
        newest = store.list(limit=1).items
        self.new_id = RunIds(after=newest[0].id if newest else None)
        self._waiting = WaitingRuns(store, self._publish)
        self._crew = Crew(store, recordings, bus, self._waiting, publish=self._publish, cores=cores)
        self._changed = self._crew.changed

    @property
    def cores(self) -> int:
        """How many jobs run at once."""
        return self._crew.cores

    @property
    def is_open(self) -> bool:
        """Whether what is queued will be started."""
        return self._crew.is_open

    def open(self) -> None:
        """Begin to start what is queued."""
        self._crew.open()

    def close(self) -> None:
        """Start no more, and end every process with a checkpoint: all is `interrupted` then."""
        self._crew.close()

    def view(self, run: Run) -> dict[str, Any]:
        """The resource of a run, with its place in the queue."""
        return run_view(run, self._waiting.position(run.id))

    def train(self, start: TrainingStart) -> Run:
        """Queue a training.

        Raises:
            InvalidInput, Conflict: if it cannot be.
            Busy: if too many runs are waiting.
        """
        return self._enqueue([training_entry(start, self._store, self.new_id)])

    def race(self, start: RaceStart) -> Run:
        """Queue a race, and before it the trainings that it brings along.

        Raises:
            InvalidInput, Conflict: if it cannot be.
            Busy: if too many runs are waiting.
        """
        return self._enqueue(race_entries(start, self._store, self.new_id))

    def experiment(self, start: ExperimentStart) -> Run:
        """Queue an experiment.

        Raises:
            InvalidInput: if it cannot be.
            Busy: if too many runs are waiting.
        """
        return self._enqueue([experiment_entry(start, self.new_id)])

    def keep(self, run: Run, table: bytes) -> None:
        """Add a training that ended elsewhere, with its table."""
        self._store.create(run)
        self._store.put_artifact(run.id, TABLE, table)
        self._publish(run)

    def pause(self, run_id: str) -> Run:
        """Let a running job wait.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it does not run, or too many are paused.
        """
        with self._changed:
            job = self._live(run_id, RUNNING, "paused")
            if self._crew.paused >= MAX_PAUSED:
                raise Conflict(f"{MAX_PAUSED} runs are paused; stop or resume one", "running")
            run = self._store.change(run_id, RUNNING, "paused", eta_s=None)
            job.pause()
            self._changed.notify_all()
        self._publish(run)
        return run

    def resume(self, run_id: str) -> Run:
        """Let a paused job go on, or queue a run again that did not come to its end.

        Raises:
            NotFound: if there is no such run.
            Conflict, InvalidInput: if it is neither, or what it needs is gone.
            Busy: if too many runs are waiting.
        """
        with self._changed:
            run = self._store.get(run_id)
            resumable = RESUMABLE[run.kind]
            if run.state in resumable:
                return self._enqueue(resumed_entries(run, self._store))
            choices = " or ".join(("paused", *sorted(resumable)))
            job = self._live(run_id, PAUSED, "resumed", choices)
            run = self._store.change(run_id, PAUSED, "running")
            job.resume()
            self._crew.note_company()
        self._publish(run)
        return run

    def stop(self, run_id: str) -> Run:
        """End a run with what has come of it, and wait until it has ended.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it has ended, or someone else is stopping it.
        """
        with self._changed:
            run = self._store.get(run_id)
            if run.state == "queued":
                for job in (self._crew.find(training) for training in run.waiting_for):
                    if job is not None and not job.stopping:
                        job.stop()
                return self._waiting.stop(run)
            job = self._live(run_id, LIVE, "stopped")
            job.stop()
        if not job.ended.wait(job.stop_grace_s):
            job.child.kill()
            job.ended.wait(_DIE_S)
        return self._store.get(run_id)

    def change(self, run_id: str, changes: Mapping[str, Any]) -> Run:
        """Change the rates or the pace of a training, and wait until that is obeyed.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it neither runs nor is paused.
            InvalidInput: if its agent has no rates.
        """
        with self._changed:
            job = self._live(run_id, LIVE, "changed")
            agent = getattr(self._store.get(run_id).config, "agent", "")
            if set(changes) - {"pace"} and not hasattr(registry.find(agent), "tune"):
                raise InvalidInput(f"{agent} has no rates that could be changed; give pace only")
            answer = job.tune(changes)
        answer.wait(_ANSWER_S)
        return self._store.get(run_id)

    def delete(self, run_id: str) -> None:
        """Forget a run that has ended.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it has not ended, or a race that waits needs it.
        """
        with self._changed:
            race = self._waiting.needing(run_id)
            if race is not None:
                state = self._store.get(run_id).state
                raise Conflict(f"race {race.id} waits, and needs its table", state)
            self._store.delete(run_id)
        self._recordings.discard(run_id)
        self._bus.publish("run-deleted", {"id": run_id}, run_id)

    def _enqueue(self, entries: list[Entry]) -> Run:
        with self._changed:
            self._waiting.add(entries, max(0, self.cores - self._crew.running))
            self._changed.notify_all()
        run = entries[-1].run
        if self._on_queued is not None and run.kind != "experiment":
            self._on_queued(run.id)
        return run

    def _live(
        self, run_id: str, states: frozenset[State], what: str, choices: str | None = None
    ) -> Job:
        """The job of a run in one of these states, that nobody is stopping."""
        run = self._store.get(run_id)
        job = self._crew.find(run_id)
        if run.state not in states or job is None:
            choices = choices or " or ".join(sorted(states))
            raise Conflict(
                f"{run.kind} {run_id} is {run.state}; it can be {what} while it is {choices}",
                run.state,
            )
        if job.stopping:
            raise Conflict(f"{run.kind} {run_id} is {run.state} and being stopped", run.state)
        return job

    def _publish(self, run: Run) -> None:
        self._bus.publish("run", self.view(run), run.id)
