"""State machine of the stage: its transition table, and random events against its rules."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.stage.state_machine import (
    PHASES,
    TRANSITIONS,
    Event,
    Origin,
    Phase,
    StagedRun,
    StageState,
)
from app.storage.run import STATES, State

RACE = StagedRun("race", "running")


def staged(phase: Phase, origin: Origin = "started") -> StageState:
    """Return a state in a phase, with the run `race` unless it is empty."""
    if phase == "empty":
        return StageState()
    run = RACE if phase in ("live", "decided") else RACE._replace(state="finished")
    state = StageState().show((run,), origin)
    return state.apply("reached-end") if phase in ("decided", "ended") else state


def test_table_has_each_phase() -> None:
    assert set(TRANSITIONS) == set(PHASES)
    assert [staged(phase).phase for phase in PHASES] == list(PHASES)


@pytest.mark.parametrize(
    ("phase", "event", "after"),
    [
        ("live", "reached-end", "decided"),
        ("live", "computed", "showing"),
        ("live", "left-end", "live"),
        ("decided", "left-end", "live"),
        ("decided", "computed", "ended"),
        ("showing", "reached-end", "ended"),
        ("showing", "continued", "live"),
        ("ended", "left-end", "showing"),
        ("ended", "continued", "decided"),
        ("empty", "reached-end", "empty"),
    ],
)
def test_transition(phase: Phase, event: Event, after: Phase) -> None:
    assert staged(phase).apply(event).phase == after


def test_started_run_does_not_take_a_live_stage() -> None:
    assert staged("live").is_held
    assert staged("decided").is_held, "it is still computed"
    assert not staged("showing").is_held
    waiting = StageState().show((StagedRun("training", "finished"), RACE), "started")
    assert waiting.is_held, "the race to come is computed"


def test_replay_is_announced_only_after_a_finished_run_that_nobody_chose() -> None:
    assert staged("empty").announce("other").announced == "other"
    assert staged("ended", "started").announce("other").announced == "other"
    assert staged("ended", "automatic").announce("other").announced == "other"
    assert staged("ended", "chosen").announce("other").announced is None
    assert staged("showing", "started").announce("other").announced is None
    stopped = StageState().show((StagedRun("race", "stopped"),), "started").apply("reached-end")
    assert stopped.announce("other").announced is None


def test_person_who_wants_a_run_to_stay_has_chosen_it() -> None:
    state = staged("ended").announce("other").stay()

    assert (state.origin, state.announced) == ("chosen", None)
    assert state.announce("other") == state
    assert StageState().stay().announce("other").announced is None, "nor an empty stage"


def test_run_that_is_shown_again_goes_on_and_one_that_was_resumed_is_live() -> None:
    ended = staged("ended")

    assert ended.show(ended.playlist, "chosen").phase == "ended"
    assert ended.show((RACE._replace(state="queued"),), "started").phase == "decided"


def test_deleted_run_gives_way_to_the_next_of_the_playlist() -> None:
    state = StageState().show((StagedRun("training", "finished"), RACE), "started")

    assert state.remove("training").playlist == (RACE,)
    assert state.remove("training").phase == "live"
    assert state.remove("training").remove("race") == StageState()
    assert state.remove("race").playlist == (StagedRun("training", "finished"),)
    assert staged("ended").announce("other").remove("other").announced is None


@pytest.mark.parametrize("state", ["stopped", "failed", "interrupted"])
def test_race_that_ended_before_it_began_is_not_shown_after_its_training(state: State) -> None:
    practice, race = StagedRun("training", "running"), StagedRun("race", "queued", has_begun=False)
    shown = StageState().show((practice, race), "started")
    void = race._replace(state=state)

    assert shown.change(void).playlist == (practice,)
    assert not shown.change(void).change(practice._replace(state=state)).is_held
    assert StageState().show((practice, void), "started").playlist == (practice,)
    assert StageState().show((void,), "chosen").run == void, "but where a person chooses it"
    assert shown.change(void._replace(has_begun=True)).playlist[1:] == (
        void._replace(has_begun=True),
    ), "what has begun has a picture, or a reason why not"


IDS = st.sampled_from(["a", "b", "c"])
RUNS = st.builds(StagedRun, IDS, st.sampled_from(STATES), st.booleans())
COMMANDS = st.one_of(
    st.tuples(
        st.just("show"),
        st.lists(RUNS, min_size=1, max_size=3, unique_by=lambda run: run.id).map(tuple),
        st.sampled_from(["started", "chosen", "automatic"]),
    ),
    st.tuples(st.just("apply"), st.sampled_from(["reached-end", "left-end"])),
    st.tuples(st.just("change"), RUNS),
    st.tuples(st.just("remove"), IDS),
    st.tuples(st.just("announce"), IDS),
    st.tuples(st.just("stay")),
)


@given(st.lists(COMMANDS, max_size=30))
def test_any_sequence_keeps_the_rules(commands: list[tuple[str, ...]]) -> None:
    """The phase always tells the run's own state, and what a person chose is never replaced."""
    state, states = StageState(), dict[str, State]()
    for verb, *arguments in commands:
        before = state
        state = getattr(state, verb)(*arguments)

        run = state.run
        assert (run is None) == (state.phase == "empty")
        if run is not None:
            assert (state.phase in ("live", "decided")) == run.is_computed
        if verb == "show":
            states = {run.id: run.state for run in arguments[0]}  # type: ignore[attr-defined]
        if verb == "change":
            changed: StagedRun = arguments[0]  # type: ignore[assignment]
            states |= {changed.id: changed.state} if changed.id in states else {}
        assert all(states[run.id] == run.state for run in state.playlist)
        assert not any(run.is_void for run in state.playlist[1:])
        if before.origin == "chosen" and verb not in ("show", "remove"):
            playlist = [run.id for run in state.playlist]
            assert playlist[:1] == [run.id for run in before.playlist][:1]
            assert set(playlist) <= {run.id for run in before.playlist}
            assert state.announced is None
        if state.announced is not None:
            assert state.may_announce
