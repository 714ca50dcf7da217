"""Rebuild a learner at any step of its practice from the log of transitions, without physics.

A new learner, with the seed of the training, is fed the logged transitions. It must choose the same
actions: then it is the learner of the training, to the last bit.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hexapods.agents.derived_explanation import explain_choice, explain_update
from hexapods.agents.explanation import ChoiceExplanation, UpdateExplanation
from hexapods.agents.protocol import Agent, Transition, Tunable, Valuing
from hexapods.domain.errors import HexapodError
from hexapods.domain.feet import Feet, StepLaw
from hexapods.domain.kinematics import check_reach
from hexapods.domain.observation import Observation, legal_actions
from hexapods.domain.types import Action, Cells, FloatArray
from hexapods.runs import seeding
from hexapods.runs.config import WalkingProblem
from hexapods.runs.presses import apply_presses
from hexapods.runs.recording import Arrays
from hexapods.runs.transition_log import Logged


class NotRebuilt(HexapodError):
    """A learner cannot be rebuilt: its actions differ from those in the log."""


class LoggedSensors:
    """Implements the `Observe` protocol by the log; the plan of the feet follows from the actions.

    Attributes:
        feet: offsets of the feet by dead reckoning.
    """

    def __init__(self, walk: WalkingProblem, observation: Observation) -> None:
        """Create the sensors of a robot at rest.

        Args:
            walk: the walking problem.
            observation: the observation mode.
        """
        self._grid, self._observation = walk.grid, observation
        gait = walk.resolved_gait
        self._law = StepLaw(gait, self._grid, check_reach(walk.robot, gait, self._grid))
        self.feet = self._law.at_home()
        self.see(self.feet.commanded, self.feet.commanded)

    def see(self, observation: Cells, measured: Cells) -> None:
        """Set the observed and the measured cells; the latter are () where not recorded."""
        self._cells: dict[Observation, Cells] = {self._observation: observation}
        if measured:
            self._cells["measured"] = measured

    def legal(self, observation: Cells) -> Sequence[Action]:
        """Return the legal actions."""
        return self._law.possible(self.feet, legal_actions(observation, len(self._grid)))

    def move(self, action: Action) -> None:
        """Carry out an action in the plan."""
        _, self.feet, _ = self._law.step(self.feet, action)

    def __call__(self, how: Observation) -> Cells:
        """Return the observed cells, one per group."""
        if how in self._cells:
            return self._cells[how]
        if how == "commanded":
            return self.feet.commanded
        if how == "measured":
            raise NotRebuilt("what its feet measured was not recorded, and its agent reads it")
        return tuple(self._grid.nearest(x, y) for x, y in self.planned_offsets_m)

    @property
    def planned_offsets_m(self) -> Sequence[tuple[float, float]]:
        """Each group's offset (x, y) from home by dead reckoning."""
        return self.feet.offsets_m

    @property
    def heading_rad(self) -> float:
        """Not recorded in a log.

        Raises:
            NotRebuilt: always.
        """
        raise NotRebuilt("the robot's heading was not recorded, and its agent reads it")


@dataclass(frozen=True)
class LearnerSnapshot:
    """State of a rebuilt learner after some steps."""

    step: int
    tuned: int
    agent: Arrays
    rng: str
    feet: Feet
    next_action: Action | None

    @property
    def size(self) -> int:
        """Approximate size in memory [bytes]."""
        return sum(array.nbytes for array in self.agent.values()) + 2000


@dataclass(frozen=True)
class ExplainedStep:
    """A step, explained by the learner that took it.

    Attributes:
        step: number of the step, from 1.
        logged: entry of the log for the step.
        visits: visit counts of the actions in this state before the step, (groups, cells); None
            for a learner that does not count visits.
        choice: explanation of its choice; None for a learner that does not explain.
        update: explanation of its update; None for one that does not explain, or did not learn.
        chose_early: whether it chose before it learned from the step before.
    """

    step: int
    logged: Logged
    visits: FloatArray | None
    choice: ChoiceExplanation | None
    update: UpdateExplanation | None
    chose_early: bool = False


class RebuiltLearner:
    """A learner that is fed the log of its walk.

    Attributes:
        agent: the learner.
        learns: whether it learned from its steps.
        step: number of steps that it has taken.
        tuned: number of changes of settings that were applied to it.
    """

    def __init__(
        self,
        agent: Agent,
        rng: np.random.Generator,
        sensors: LoggedSensors,
        *,
        learns: bool = True,
    ) -> None:
        """Take a new learner, with the generator and the sensors that it was built with."""
        self.agent, self.learns, self.step, self.tuned = agent, learns, 0, 0
        self._rng, self._sensors = rng, sensors
        self._next_action: Action | None = None
        self._next_choice: ChoiceExplanation | None = None

    @property
    def chooses_early(self) -> bool:
        """Whether the learner chooses the next action before it learns from the last one."""
        return self.learns and bool(getattr(self.agent, "is_on_policy", False))

    @property
    def can_explain(self) -> bool:
        """Whether the choice of the next step is explained, or can be: it was not made yet."""
        return self._next_action is None or self._next_choice is not None

    def tune(self, change: Mapping[str, Any]) -> None:
        """Change settings as in the training, from the next step on."""
        if "settings" in change and isinstance(self.agent, Tunable):
            self.agent.tune(**change["settings"])
        apply_presses(self.agent, change.get("presses", ()))
        self.tuned += 1

    def take(self, logged: Logged, *, explain_next: bool = False) -> None:
        """Take the next step of the log.

        Args:
            logged: the step.
            explain_next: whether the choice of the step after it is to be explained, if that is
                made now.

        Raises:
            NotRebuilt: if the learner chooses another action than is logged.
        """
        self._choose(logged, explain=False)
        transition = self._end(logged, explain_next)
        if transition is not None:
            self.agent.learn(transition)
        self.step += 1

    def explain(self, logged: Logged) -> ExplainedStep:
        """Take the next step of the log, and explain it.

        Raises:
            NotRebuilt: if the learner chooses another action than is logged.
        """
        agent, update = self.agent, None
        visits = agent.visits(logged.observation) if isinstance(agent, Valuing) else None
        chose_early = self._next_action is not None
        choice = self._choose(logged, explain=True)
        transition = self._end(logged, explain_next=True)
        if transition is not None:
            update = explain_update(agent, transition)
        self.step += 1
        return ExplainedStep(self.step, logged, visits, choice, update, chose_early)

    def _choose(self, logged: Logged, explain: bool) -> ChoiceExplanation | None:
        """Let the learner choose the action of a step, unless it has."""
        self._sensors.see(logged.observation, logged.measured)
        action, choice = self._next_action, self._next_choice
        if action is None:
            action, choice = self._decide(logged.observation, explain)
        if action != logged.action:
            raise NotRebuilt(
                f"step {self.step + 1} cannot be explained: the learner that was built again chose "
                f"{tuple(action)} there, and the one that practised {tuple(logged.action)}"
            )
        return choice

    def _end(self, logged: Logged, explain_next: bool) -> Transition | None:
        """Return the transition from which the learner learns; None where it learns nothing."""
        self._sensors.move(logged.action)
        self._next_action = self._next_choice = None
        if not self.learns or not logged.next_observation:
            return None
        self._sensors.see(logged.next_observation, logged.next_measured)
        if self.chooses_early:
            decided = self._decide(logged.next_observation, explain_next)
            self._next_action, self._next_choice = decided
        return Transition(
            *(logged.observation, logged.action, logged.reward_m, logged.next_observation),
            self._sensors.legal(logged.next_observation),
            self._next_action,
        )

    def _decide(self, observation: Cells, explain: bool) -> tuple[Action, ChoiceExplanation | None]:
        legal = self._sensors.legal(observation)
        choice = explain_choice(self.agent, observation, legal) if explain else None
        if choice is not None:
            return choice.action, choice
        return Action(*self.agent.act(observation, legal)), None

    def snapshot(self) -> LearnerSnapshot:
        """Return the state after the steps so far."""
        return LearnerSnapshot(
            *(self.step, self.tuned, self.agent.state(), seeding.dump(self._rng)),
            *(self._sensors.feet, self._next_action),
        )

    def restore(self, snapshot: LearnerSnapshot) -> None:
        """Restore a state into a new learner."""
        # A copy, which the agent may change.
        self.agent.load({name: array.copy() for name, array in snapshot.agent.items()})
        seeding.load(self._rng, snapshot.rng)
        self.step, self.tuned = snapshot.step, snapshot.tuned
        self._sensors.feet, self._next_action = snapshot.feet, snapshot.next_action
