"""TAMER: learns from the presses of + and − of those who watch (Knox and Stone, K-CAP 2009)."""

import math
from collections.abc import Sequence
from typing import Annotated, Any, Literal

import numpy as np
from annotated_types import Ge, Gt, Le

from hexapods.agents.explanation import (
    ChoiceExplanation,
    Term,
    UpdateExplanation,
    ValueUpdate,
)
from hexapods.agents.protocol import AgentState, Press, Problem, Transition
from hexapods.agents.q_table import check_entries
from hexapods.agents.tabular import Alpha, Share, TabularAgent
from hexapods.domain.errors import InvalidInput
from hexapods.domain.settings import Setting, declare
from hexapods.domain.sums import ordered_sum
from hexapods.domain.types import Action, Cells

PRESS_M = 0.01
"""Reward that a press of + stands for [m], that of a good step: so its values are in metres."""
MEMORY_STEPS = 32
"""Newest steps that a press may be about."""
Trainer = Annotated[
    Literal["simulated", "reward", "people"],
    Setting(
        title="Trainer",
        help="Who presses + and −: a simulated person who sees each step's reward inexactly and "
        "answers late; nobody, and it learns the reward itself; or people, by presses that a "
        "training is sent.",
        choice_titles=("simulated person", "the reward itself", "people"),
    ),
]
WatchedStep = Annotated[
    float,
    Ge(0.05),
    Le(10),
    Setting(
        title="Step as it is watched",
        unit="s",
        help="How long a step lasts for who presses: the slower, the surer which step is meant.",
        examples=(0.64, 1.28),
    ),
]
Delay = Annotated[
    float,
    Gt(0),
    Le(5),
    Setting(
        title="Delay of a press",
        unit="s",
        help="Time that people take to press, on average; the steps before share a press by it.",
        examples=(0.3, 0.56),
    ),
]
Noise = Annotated[
    float,
    Ge(0),
    Le(1),
    Setting(
        title="Noise of the trainer",
        unit="m",
        help="Standard deviation of the error with which a simulated person sees a reward.",
        examples=(0, 0.005),
    ),
]
Attention = Annotated[
    Share,
    Setting(
        title="Attention",
        help="Share of the steps on which a simulated person presses.",
        examples=(0.5, 1),
    ),
]


class Tamer(TabularAgent):
    """Learner of what people will press; it takes the step for which they press + most surely.

    It learns a model H(s, a) of human reinforcement, and is greedy in it: it looks one step ahead,
    since who presses has judged already what a step leads to. It does not explore: what was
    pressed − sends it elsewhere. Untried steps have the value 0, and ties are broken at random.

    A press comes late, and is about one of the steps before it (credit assignment). The delay of a
    press has a gamma distribution of shape 2, whose cumulative distribution is
    F(d) = 1 − (1 + d/θ) exp(−d/θ), θ being half the mean delay. A press at time t is credited to a
    step that was seen from b to e with the probability c = F(t − b) − F(t − e). All steps that
    share in a press of value h then learn from the one error of what was predicted (the paper's
    update, with one feature for each state and action):

        δ = h − Σ cᵢ H(sᵢ, aᵢ),    H(sᵢ, aᵢ) ← H(sᵢ, aᵢ) + α cᵢ δ

    Times of presses are in steps of the walk, delays in seconds of who watches; a step lasts
    `watched_step_s` for them. H is in metres: a press of + counts as `PRESS_M`, and so do values
    between −1 and 1, the mean of several who press, in proportion.

    Args:
        rng: random generator for breaking ties and for the simulated trainer.
        problem: determines the size of the table.
        explore: False in evaluations, where nothing is learned; it never explores.
        alpha: learning rate α.
        trainer: `simulated`: after each step, with the probability `attention`, + is pressed if its
            reward with a normal error of `noise_m` is positive, else −, with a random delay.
            `reward`: H(s, a) ← H(s, a) + α (r − H(s, a)), without presses. `people`: presses come
            by `feel` alone.
        watched_step_s: duration of a step for who presses [s].
        delay_s: mean delay of a press [s]; the paper's is 0.56.
        noise_m: standard deviation of the simulated trainer's error [m].
        attention: share of the steps on which the simulated trainer presses.
    """

    title = "TAMER"
    description = "Learns from those who watch and press + or −, and does what they will like."
    color = "#E2007A"

    def __init__(
        self,
        rng: np.random.Generator,
        problem: Problem,
        *,
        explore: bool = True,
        alpha: Alpha = 0.5,
        trainer: Trainer = "simulated",
        watched_step_s: WatchedStep = 1.28,
        delay_s: Delay = 0.56,
        noise_m: Noise = 0.003,
        attention: Attention = 0.8,
    ) -> None:
        super().__init__(rng, problem, explore=explore)
        self._alpha, self._trainer = alpha, trainer
        self._watched_step_s, self._delay_s = watched_step_s, delay_s
        self._noise_m, self._attention = noise_m, attention
        self._taken = 0
        """Number of steps that it has taken."""
        self._recent: list[tuple[int, int]] = []
        """State and column of the newest steps, the newest last."""
        self._coming: list[Press] = []
        """Presses of the simulated trainer that are still to come, in the order of their steps."""
        self._explained: list[ValueUpdate] | None = None
        """Updates since `explain_update` began; None outside of it."""

    def learn(self, transition: Transition) -> None:
        """Remember the step, and learn from the trainer's presses that have come by now."""
        table = self.table
        state, column = table.index(transition.observation), table.column(transition.action)
        table.count_visit(state, column)
        self._recent = [*self._recent, (state, column)][-MEMORY_STEPS:]
        self._taken += 1
        if self._trainer == "reward":
            before, rate, reward_m = table.value(state, column), self._alpha, transition.reward_m
            terms = (
                *(Term("Q", before, "value before"), Term("α", rate, "learning rate")),
                Term("r", reward_m, "reward of this step [m]"),
            )
            after = before + rate * (reward_m - before)
            self._write((state, column), "Q + α · (r − Q)", terms, after)
        elif self._trainer == "simulated":
            self._judge(transition.reward_m)
            self.feel([press for press in self._coming if press.at_step <= self._taken])
            self._coming = [press for press in self._coming if press.at_step > self._taken]

    def feel(self, presses: Sequence[Press]) -> None:
        """Learn from presses, in this order; one of no step that is remembered changes nothing."""
        for press in presses:
            first = self._taken - len(self._recent)
            shares = [
                (pair, self.credit(press.at_step - number))
                for number, pair in enumerate(self._recent, start=first)
            ]
            predicted = ordered_sum(share * self.table.value(*pair) for pair, share in shares)
            error = press.value * PRESS_M - predicted
            for pair, share in shares:
                if share > 0:
                    before = self.table.value(*pair)
                    terms = (
                        *(
                            Term("Q", before, "value before"),
                            Term("α", self._alpha, "learning rate"),
                        ),
                        Term("c", share, "credit: how likely the press was about this step"),
                        Term("δ", error, "the press, less what was predicted of these steps [m]"),
                    )
                    after = before + self._alpha * share * error
                    self._write(pair, "Q + α · c · δ", terms, after)

    def _write(
        self, pair: tuple[int, int], rule: str, terms: tuple[Term, ...], after: float
    ) -> None:
        if self._explained is not None:
            state, column = pair
            place = self.table.cells_at(state), self.table.action_at(column)
            before = self.table.value(*pair)
            self._explained.append(ValueUpdate(*place, rule, terms, before, after))
        self.table.set_value(*pair, after)

    def credit(self, after_steps: float) -> float:
        """Return the share of a press that a step has which began so many steps before it."""
        begun_s = after_steps * self._watched_step_s
        return self._delay_share(begun_s) - self._delay_share(begun_s - self._watched_step_s)

    def _delay_share(self, delay_s: float) -> float:
        """Return the share of presses with a shorter delay: the gamma distribution of shape 2."""
        if delay_s <= 0:
            return 0.0
        ratio = 2 * delay_s / self._delay_s
        return 1 - (1 + ratio) * math.exp(-ratio)

    def _judge(self, reward_m: float) -> None:
        """Let the simulated trainer press for the newest step, or not."""
        attends, late_s = (
            self._rng.random() < self._attention,
            self._rng.gamma(2, self._delay_s / 2),
        )
        seen_m = reward_m + self._noise_m * self._rng.standard_normal()
        if attends:
            # It is judged when half of it is seen.
            at_step = self._taken - 0.5 + late_s / self._watched_step_s
            self._coming.append(Press(float(at_step), 1.0 if seen_m > 0 else -1.0))
            self._coming.sort()

    def explain_choice(self, observation: Cells, legal: Sequence[Action]) -> ChoiceExplanation:
        """Choose as `act` does, and explain the choice."""
        scores = self.values(observation)
        action = self.act(observation, legal)
        return ChoiceExplanation(action, "exploited", "press that it predicts", scores)

    def explain_update(self, transition: Transition) -> UpdateExplanation:
        """Learn as `learn` does, and explain the updates by the presses that came meanwhile."""
        updates: list[ValueUpdate] = []
        self._explained = updates
        try:
            self.learn(transition)
        finally:
            self._explained = None
        place = transition.observation, transition.action
        direct = next((x for x in updates if (x.observation, x.action) == place), None)
        others = [update for update in updates if update is not direct]
        return UpdateExplanation(self._summary(len(updates)), direct, others)

    def _summary(self, updates: int) -> str:
        if self._trainer == "people":
            return (
                "The step itself teaches it nothing: it learns when somebody presses, and shares "
                "each press among the newest steps."
            )
        if self._trainer == "reward":
            return "Nobody presses: its value moves towards the reward of the step."
        if not updates:
            return "No press came during this step, so no value changes."
        values = "one value changes" if updates == 1 else f"{updates} values change"
        return f"A press came during this step: {values}, by how likely it was about each step."

    @staticmethod
    def check_unattended(trainer: str = "simulated", **_settings: Any) -> None:
        """Check that it learns also where no presses come.

        Raises:
            InvalidInput: if people are to train it.
        """
        if trainer == "people":
            raise InvalidInput(
                "tamer with the trainer people learns from presses alone, and here are none: give "
                'them as changes, such as [{"step": 14, "presses": [[12.4, 1]]}], teach it in a '
                "room or by PATCH /api/v1/trainings/ID, or choose the trainer simulated or reward"
            )

    def tune(self, *, alpha: Alpha | None = None) -> None:
        """Change the learning rate from the next press on."""
        self._alpha = self._alpha if alpha is None else alpha

    def state(self) -> AgentState:
        """Return the table, the newest steps, the presses to come, and the learning rate."""
        return {
            **self.table.dump(),
            "rate": np.array([self._alpha]),
            "taken": np.array([self._taken], np.int64),
            "recent": np.array(self._recent, np.int64).reshape(-1, 2),
            "coming": np.array(self._coming, float).reshape(-1, 2),
        }

    def load(self, state: AgentState) -> None:
        """Restore a state that `state` returned; the caller restores the generator."""
        self._load_learned(state)
        (self._alpha,), (self._taken,) = state["rate"].tolist(), state["taken"].tolist()
        self._recent = [(row, column) for row, column in state["recent"].tolist()]
        self._coming = [Press(at_step, value) for at_step, value in state["coming"].tolist()]

    @staticmethod
    def check_state(state: AgentState) -> None:
        """Check the learning rate, the newest steps and the presses of a saved state.

        Raises:
            InvalidInput: for a rate out of its limits.
            KeyError, TypeError, ValueError: if `state` is not a state of this agent.
        """
        (alpha,), (taken,) = state["rate"].tolist(), state["taken"].tolist()
        declare("alpha", Alpha).check(alpha)
        recent, coming = state["recent"], state["coming"]
        if not isinstance(taken, int) or not len(recent) <= min(taken, MEMORY_STEPS):
            raise ValueError("its newest steps are more than it has taken or remembers")
        check_entries(recent, len(recent), state["shape"])
        if coming.ndim != 2 or coming.shape[1] != 2 or coming.dtype.kind != "f":
            raise ValueError("its presses to come are no times and values")
        if not np.isfinite(coming).all() or (np.abs(coming[:, 1]) > 1).any():
            raise ValueError("its presses to come are no times and values from -1 to 1")
