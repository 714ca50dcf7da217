"""Explanations of a learner's steps: why it chose an action, and how its values changed.

A rule is arithmetic over named terms, such as `(1 − α) · Q + α · (r + γ · Q′)`: `evaluate` gives
what the learner computed, to the last bit. `derived_explanation` derives them for learners with a
Q-table; other learners may explain themselves (`Explaining`).
"""

import ast
import operator
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol, runtime_checkable

import numpy as np

from hexapods.agents.protocol import Transition
from hexapods.domain.types import Action, Cells, FloatArray


class Term(NamedTuple):
    """A number in a rule."""

    symbol: str
    value: float
    meaning: str


Rule = tuple[str, Sequence[Term]]
"""Formula of a number, in the symbols of its terms."""


class ValueUpdate(NamedTuple):
    """Update of one value by a rule."""

    observation: Cells
    """The state whose value it is."""
    action: Action
    rule: str
    """Formula of the new value, in the symbols of the terms."""
    terms: tuple[Term, ...]
    before: float
    after: float

    @property
    def numbers(self) -> str:
        """The rule with rounded numbers in place of its symbols."""
        return _substituted(self.rule, self.terms, _rounded)

    @property
    def is_exact(self) -> bool:
        """Whether the rule gives the value after the update, to the last bit."""
        return evaluate(self.rule, self.terms) == self.after


class Belief(NamedTuple):
    """Quantity of a learned model, such as an expected reward, before and after a step."""

    name: str
    before: float
    after: float
    unit: str = "m"
    deviation_before: float | None = None
    """Standard deviation of the belief; None for a model without one."""
    deviation_after: float | None = None


@dataclass(frozen=True)
class UpdateExplanation:
    """Update of a learner's values by a transition.

    Attributes:
        summary: one or two sentences.
        update: update of the value of the step itself; None if that was not updated.
        others: further updates, such as planned ones and those of earlier steps, in order. None of
            the value of `update` is before it.
        beliefs: estimates of a model about the step.
    """

    summary: str
    update: ValueUpdate | None = None
    others: Sequence[ValueUpdate] = ()
    beliefs: Sequence[Belief] = ()

    @property
    def stored(self) -> float | None:
        """The value of `update` after all updates, as later ones may have changed it again."""
        if self.update is None:
            return None
        place = self.update.observation, self.update.action
        updates = [self.update, *self.others]
        return [update.after for update in updates if (update.observation, update.action) == place][
            -1
        ]


@dataclass(frozen=True)
class ChoiceExplanation:
    """Why a learner chose an action.

    Attributes:
        action: the action.
        kind: whether it was the best by the scores, a random one, or one that is tried because it
            is unknown.
        criterion: name of the scores.
        scores: scores of the actions [m], (groups, cells); NaN for an action without one.
        epsilon: probability of a random action; None for a learner without ε.
        draw: the random number that was compared with ε; None if none was drawn.
    """

    action: Action
    kind: Literal["exploited", "explored", "unknown"]
    criterion: str
    scores: FloatArray
    epsilon: float | None = None
    draw: float | None = None

    @property
    def best(self) -> Sequence[Action]:
        """The actions with the highest score; several if they are tied."""
        highest = np.nanmax(self.scores)
        return [Action(*place) for place in np.argwhere(self.scores == highest).tolist()]

    @property
    def runner_up(self) -> Action | None:
        """The action with the highest score beside the chosen one; None if there is no other."""
        other_scores = self.scores.copy()
        other_scores[self.action] = np.nan
        if np.isnan(other_scores).all():
            return None
        return Action(*map(int, np.unravel_index(np.nanargmax(other_scores), other_scores.shape)))

    @property
    def margin(self) -> float | None:
        """Difference of its score and the runner-up's [m]; negative if its own is lower."""
        runner_up = self.runner_up
        if runner_up is None:
            return None
        return float(self.scores[self.action] - self.scores[runner_up])

    @property
    def probability(self) -> float:
        """Probability of this action in this state, by exploration and by ties."""
        if self.kind == "unknown":
            return 1.0 / len(self.best)
        epsilon, count = self.epsilon or 0.0, int(np.isfinite(self.scores).sum())
        best = self.best
        return epsilon / count + (1 - epsilon) * (self.action in best) / len(best)


class Future(NamedTuple):
    """Simulated return of an action of the present state, as a search compared it."""

    action: Action
    reward_m: float
    """Reward of the step, as simulated."""
    return_m: float
    """The score compared, such as the highest sum of rewards of the sequences below."""
    sequences: int
    """Simulated sequences of steps that begin with it."""
    steps: int
    """Number of steps ahead that these go."""


@runtime_checkable
class ExplainingSearch(Protocol):
    """Search that returns the futures which it compared for its newest decision.

    Its class says in `compares` what `Future.return_m` is.
    """

    def futures(self) -> Sequence[Future]:
        """Return the reward and the return of each action that was simulated."""


@runtime_checkable
class Explaining(Protocol):
    """Learner that explains its steps itself, without a class of `derived_explanation` for it."""

    def explain_choice(self, observation: Cells, legal: Sequence[Action]) -> ChoiceExplanation:
        """Choose as `act` does, and explain the choice."""

    def explain_update(self, transition: Transition) -> UpdateExplanation:
        """Learn as `learn` does, and explain how what is known changes."""


_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_OPERATORS: Mapping[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}


def evaluate(rule: str, terms: Sequence[Term]) -> float:
    """Return the value of a rule with the numbers of its terms, in IEEE double precision.

    Raises:
        ValueError: if a symbol is not among the terms, or the rule is not arithmetic.
    """
    text = _substituted(rule, terms, repr).replace("−", "-").replace("·", "*")
    try:
        return _value(ast.parse(text, mode="eval").body)
    except SyntaxError as error:
        raise ValueError(f"{text} is no arithmetic") from error


def _value(node: ast.expr) -> float:
    if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
        return _OPERATORS[type(node.op)](_value(node.left), _value(node.right))
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return -_value(node.operand)
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        return node.value
    raise ValueError(f"{ast.unparse(node)} is no arithmetic")


def _substituted(rule: str, terms: Sequence[Term], text_of: Callable[[float], str]) -> str:
    """Return a rule with numbers in place of its symbols; negative ones in parentheses."""
    values = {term.symbol: float(term.value) for term in terms}
    longest_first = sorted(values, key=len, reverse=True)
    if not longest_first:
        return rule

    def number(match: re.Match[str]) -> str:
        text = text_of(values[match[0]])
        return f"({text})" if text[0] in "-−" else text

    return re.sub("|".join(map(re.escape, longest_first)), number, rule)


def _rounded(value: float) -> str:
    mantissa, _, exponent = f"{value:.4g}".partition("e")
    power = f" · 10{str(int(exponent)).translate(_SUPERSCRIPTS)}" if exponent else ""
    return mantissa.replace("-", "−") + power


def in_millimetres(metres: float) -> str:
    """Return a length for a sentence, to a tenth of a millimetre, as the page does: "12.3 mm"."""
    text = f"{1000 * float(metres):.1f} mm"
    return "0.0 mm" if text == "-0.0 mm" else text.replace("-", "−")


def copy_of(rng: np.random.Generator) -> np.random.Generator:
    """Return a copy of a generator, which draws the same numbers."""
    bits = type(rng.bit_generator)()
    bits.state = rng.bit_generator.state
    return np.random.Generator(bits)
