"""An explained step in three sentences: what it brought, why this move, and what it missed."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from app.features.explanations.names import ActionNames
from hexapods.agents.explanation import ChoiceExplanation, Future, in_millimetres
from hexapods.domain.types import Action, FloatArray
from hexapods.runs.rebuilding import ExplainedStep


class SearchFindings(NamedTuple):
    """Findings of a search before a step.

    Attributes:
        compares: what it compared.
        transitions: number of steps that it simulated.
        futures: what it found about each action.
    """

    compares: str
    transitions: int
    futures: Sequence[Future]


@dataclass(frozen=True)
class StepSentences:
    """Sentences about a step.

    Attributes:
        what: what the step brought.
        why: why its move was made; None where the choice is not explained.
        missed: what was passed over or not seen; None where the choice is not explained.
    """

    what: str
    why: str | None
    missed: str | None


def futures_in_order(search: SearchFindings, action: Action) -> list[Future]:
    """Return the futures of a search: that of its action first, then by what they promise."""
    return sorted(search.futures, key=lambda future: (future.action != action, -future.return_m))


def sentences_of(
    explained: ExplainedStep, search: SearchFindings | None, names: ActionNames
) -> StepSentences:
    """Return the sentences about a step.

    Args:
        explained: the step.
        search: what a search found; None for an agent that does not search.
        names: of the moves.
    """
    logged, choice = explained.logged, explained.choice
    what = _what(logged.reward_m, explained.visits, logged.action)
    if search is not None:
        chosen, *further = futures_in_order(search, logged.action)
        why = _why_simulated(search, chosen, further, names)
        return StepSentences(what, why, _missed_simulated(chosen, logged.reward_m))
    if choice is None:
        return StepSentences(what, None, None)
    early = " It went by the values before it learned from the step before." * explained.chose_early
    why = f"{_why(choice, names)}.{early}"
    return StepSentences(what, why, _missed(choice, explained.visits, names))


def _what(reward_m: float, visits: FloatArray | None, action: Action) -> str:
    way = "back" if reward_m < 0 else "forward"
    came = f"The step brought {in_millimetres(abs(reward_m))} {way}"
    if visits is None:
        return f"{came}."
    tried = int(visits[action])
    if not tried:
        return f"{came}; it was the first try of this move from there."
    before = "once" if tried == 1 else f"{tried} times"
    return f"{came}; this move had been tried {before} from there."


# ---- why the move was made


def _why_simulated(
    search: SearchFindings, chosen: Future, further: Sequence[Future], names: ActionNames
) -> str:
    beside = ""
    if further:
        more = in_millimetres(chosen.return_m - further[0].return_m)
        is_level = more == in_millimetres(0.0)
        beside = f", {'level with' if is_level else f'{more} more than'} the next, "
        beside += names.move(further[0].action)
    return (
        f"It simulated {_counted(search.transitions, 'step')} and compared the {search.compares}: "
        f"this move came first with {in_millimetres(chosen.return_m)} in "
        f"{_counted(chosen.steps, 'step')}{beside}."
    )


def _why(choice: ChoiceExplanation, names: ActionNames) -> str:
    """Return why a learner made its move, without the stop."""
    tied = len(choice.best)
    if choice.kind == "unknown":
        lot = f", one of {tied} such moves, drawn by lot" if tied > 1 else ""
        return f"It does not know yet what this move brings{lot}"
    if choice.kind == "explored":
        return (
            f"It explored: {choice.draw:.3f} was drawn, below ε = {choice.epsilon:.3f}, so one of "
            f"{_legal(choice)} moves was taken by lot"
        )
    drawn = ""
    if choice.draw is not None:
        drawn = f", as {choice.draw:.3f} was drawn, not below ε = {choice.epsilon:.3f}"
    held = in_millimetres(choice.scores[choice.action])
    best = f"It took what it holds for best{drawn}: {held} is the highest {choice.criterion}"
    if tied > 1:
        return f"{best}, which {tied} moves have; one was drawn by lot"
    if choice.runner_up is None or choice.margin is None:
        return best
    return f"{best}, {in_millimetres(choice.margin)} above {names.move(choice.runner_up)}"


# ---- what was missed


def _missed_simulated(chosen: Future, reward_m: float) -> str:
    differs = reward_m - chosen.reward_m
    came = "what came is what it foresaw"
    if differs:
        size = in_millimetres(abs(differs))
        came = f"what came is {size} {'more' if differs > 0 else 'less'} than it foresaw"
    ahead = _counted(chosen.steps, "step")
    return f"It missed whatever comes after {ahead}, which it does not simulate; {came}."


def _missed(choice: ChoiceExplanation, visits: FloatArray | None, names: ActionNames) -> str:
    if choice.kind == "unknown":
        other = len(choice.best) - 1
        return (
            f"It missed {_counted(other, 'other move')} as unknown as this."
            if other
            else "It missed nothing as unknown as this."
        )
    if choice.kind == "explored" and choice.action not in choice.best:
        more = in_millimetres(choice.scores[choice.best[0]] - choice.scores[choice.action])
        best = f"one of {len(choice.best)} tied moves"
        if len(choice.best) == 1:
            best = names.move(choice.best[0])
        return f"It missed {best}, {more} higher by its {choice.criterion}."
    untried = 0 if visits is None else int(((visits == 0) & np.isfinite(choice.scores)).sum())
    if not untried:
        return f"It missed nothing that it knows: no move has a higher {choice.criterion}."
    of = f"{untried} of {_legal(choice)} moves"
    return f"It missed whatever {of} would bring that it has never tried from there."


def _legal(choice: ChoiceExplanation) -> int:
    return int(np.isfinite(choice.scores).sum())


def _counted(number: int, noun: str) -> str:
    return f"{number:,} {noun}{'s' * (number != 1)}"
