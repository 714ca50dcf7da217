"""Limits on the starts of a visitor of a demo, and the errors with which starts are refused."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import timedelta

from app.features.demo.settings import DemoSettings
from app.storage.errors import Busy, Forbidden
from app.storage.run import Run
from app.storage.run_kind import WALKS
from hexapods.domain.errors import InvalidInput

HOUR = timedelta(hours=1)


@dataclass(frozen=True)
class Allowance:
    """Limits on the steps, runs and computing time of visitors of a demo.

    Attributes:
        steps_per_hour: steps that a visitor may compute in any hour; of a race of all its lanes.
        hours: hours after which a visitor's runs are deleted.
        steps_per_start: steps of one start, with all the practice that a race needs.
        least_steps: minimum number of steps that a start counts as, which bounds their number.
        unended: starts of a visitor that wait or go on at once.
        kept: runs of a visitor that are kept at once, trainings and races.
        seconds_per_run: longest computing time of a run, after which it is stopped [s].
        visitors_per_address: number of visitors whose steps and starts one address has, as of a
            class.
    """

    steps_per_hour: int = DemoSettings.demo_steps_per_hour
    hours: int = DemoSettings.demo_hours
    steps_per_start: int = 10_000
    least_steps: int = 200
    unended: int = 2
    kept: int = 40
    seconds_per_run: float = 300.0
    visitors_per_address: int = 32

    @classmethod
    def of(cls, settings: DemoSettings) -> "Allowance":
        """Return the allowance of a demo with these settings."""
        return cls(settings.demo_steps_per_hour, settings.demo_hours)

    @property
    def lifetime(self) -> timedelta:
        """Time after which a visitor's runs are deleted."""
        return timedelta(hours=self.hours)

    @property
    def steps_per_hour_of_address(self) -> int:
        """Steps that all visitors of one address may compute in an hour."""
        return self.visitors_per_address * self.steps_per_hour

    @property
    def unended_of_address(self) -> int:
        """Starts of all visitors of one address that wait or go on at once."""
        return self.visitors_per_address * self.unended

    def cost(self, runs: Sequence[Run]) -> int:
        """Return the number of steps that a start is charged: at least `least_steps`."""
        return max(self.least_steps, sum(run.total for run in runs))

    def check_start(self, runs: Sequence[Run]) -> None:
        """Check kinds and steps of the runs of a start, whatever the visitor has used.

        Args:
            runs: runs of the start.

        Raises:
            Forbidden: if a run is neither a training nor a race.
            InvalidInput: if they have too many steps.
        """
        if refused_kinds := [run.kind for run in runs if run.kind not in WALKS]:
            raise Forbidden(
                "visitors of this demo start trainings and races; "
                f"{refused_kinds[0]}s need the operator"
            )
        steps, most = sum(run.total for run in runs), min(self.steps_per_start, self.steps_per_hour)
        if steps > most:
            raise InvalidInput(
                f"a visitor of this demo may start up to {most:,} steps at once, counted over "
                f"practice and all lanes; this has {steps:,}, so choose fewer steps or lanes"
            )

    def check_unended(self, count: int, of_address: int) -> None:
        """Check that another start may wait, by the number of unended starts.

        Args:
            count: unended starts of the visitor.
            of_address: unended starts of all visitors of the address.

        Raises:
            Busy: if it may not.
        """
        if count >= self.unended:
            raise Busy(
                f"{count} of your runs wait or go on, and {self.unended} may at once here; wait "
                "for one to end, or stop one",
                _RETRY_S,
            )
        if of_address >= self.unended_of_address:
            raise Busy(
                f"{of_address} runs of visitors of your network wait or go on, which is the most "
                "at once; wait for one to end",
                _RETRY_S,
            )

    def check_kept(self, count: int, added: int, first_ends_in_s: float) -> None:
        """Check that so many further runs may be kept.

        Args:
            count: runs that are kept.
            added: runs of the start.
            first_ends_in_s: time until the oldest of them is deleted [s].

        Raises:
            Busy: if they may not.
        """
        if count + added > self.kept:
            raise Busy(
                f"you keep {count} runs, and {self.kept} may be kept here; delete some, or wait: "
                f"the oldest goes {in_words(first_ends_in_s)}",
                math.ceil(max(1.0, first_ends_in_s)),
            )

    def used_up(self, cost: int, left: int, wait_s: float) -> Busy:
        """Return the refusal of a start that costs more steps than a visitor has left.

        Args:
            cost: steps that the start is charged.
            left: steps that are left.
            wait_s: time until enough are left [s].
        """
        return Busy(
            f"you have {left:,} of {self.steps_per_hour:,} steps an hour left, and this takes "
            f"{cost:,}; choose fewer, or start it {in_words(wait_s)}",
            math.ceil(wait_s),
        )

    def address_used_up(self, wait_s: float) -> Busy:
        """Return the refusal of a start if the visitors of an address have used up its steps."""
        return Busy(
            f"the visitors of your network have started {self.steps_per_hour_of_address:,} steps "
            f"within an hour, which is the most; start this {in_words(wait_s)}",
            math.ceil(max(1.0, wait_s)),
        )


_RETRY_S = 10


def in_words(seconds: float) -> str:
    """Return when something is possible again: `in 40 s`, `in 12 min`, `in 3 h`."""
    if seconds < 100:
        return f"in {max(1, math.ceil(seconds))} s"
    minutes = math.ceil(seconds / 60)
    return f"in {minutes} min" if minutes < 100 else f"in {math.ceil(minutes / 60)} h"
