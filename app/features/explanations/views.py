"""Explanations and tables as the API responds with them."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from app.features.explanations.response_models import (
    BeliefView,
    ChoiceView,
    ExplanationView,
    FutureView,
    LandingsView,
    OtherUpdates,
    SearchView,
    TableView,
    TermView,
    UpdateView,
    ValueUpdateView,
    WalkedGrid,
)
from hexapods.agents.explanation import (
    ChoiceExplanation,
    Future,
    UpdateExplanation,
    ValueUpdate,
    in_millimetres,
)
from hexapods.agents.landing_table import LandingTable
from hexapods.agents.protocol import Valuing
from hexapods.agents.value_table import ValueTable
from hexapods.domain.types import Action, Cells, FloatArray
from hexapods.runs.config import WalkingProblem
from hexapods.runs.rebuilding import ExplainedStep
from hexapods.runs.transition_log import Logged

MAX_OTHERS = 24
"""Further updates of values that are told one by one, those with the largest changes."""
MAX_VALUES_SHOWN = 30_000
"""Values in one answer."""


class ActionNames:
    """Names of the actions and states of a walking problem."""

    def __init__(self, walk: WalkingProblem) -> None:
        self._groups, self._grid = walk.resolved_gait.groups, walk.grid

    def move(self, action: Action) -> str:
        """Return the name of an action: "legs 1 and 4 to front left"."""
        legs = " and ".join(map(str, self._groups[action.group]))
        return f"legs {legs} to {self._grid.name(action.cell)}"

    @property
    def grid(self) -> WalkedGrid:
        """The groups of legs and the cells of the foot grid."""
        return WalkedGrid(
            pairs=[list(group) for group in self._groups],
            cells_m=[(x_m, y_m) for x_m, y_m in self._grid.cells.round(5).tolist()],
            cell_names=[self._grid.name(cell) for cell in range(len(self._grid))],
        )


def explanation_view(
    run_id: str,
    walk: WalkingProblem,
    agent: str,
    explained: ExplainedStep,
    *,
    lane: int | None = None,
    search: "SearchFindings | None" = None,
    unexplained: str | None = None,
) -> ExplanationView:
    """Return an explained step.

    Args:
        run_id: id of the run.
        walk: its walking problem.
        agent: name of the agent that took the step.
        explained: the step.
        lane: of a race; None for a training.
        search: what a search found; None for an agent that does not search.
        unexplained: why there is no explanation of its choice.
    """
    names, logged = ActionNames(walk), explained.logged
    return ExplanationView(
        **vars(names.grid),
        run_id=run_id,
        lane=lane,
        step=explained.step,
        agent=agent,
        observation=list(logged.observation),
        action=logged.action,
        reward_m=logged.reward_m,
        next_observation=list(logged.next_observation) or None,
        visits=None if explained.visits is None else _rows(explained.visits),
        choice=None if explained.choice is None else _choice(explained, names),
        update=None if explained.update is None else _update(explained.update, names),
        search=None if search is None else _search(search, logged, names),
        unexplained=unexplained,
    )


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


def _search(search: SearchFindings, logged: Logged, names: ActionNames) -> SearchView:
    best_first = sorted(
        search.futures, key=lambda future: (future.action != logged.action, -future.return_m)
    )
    return SearchView(
        compares=search.compares,
        transitions=search.transitions,
        futures=[FutureView(**future._asdict()) for future in best_first],
        sentences=_search_sentences(search, best_first, logged, names),
    )


def _search_sentences(
    search: SearchFindings, best_first: Sequence[Future], logged: Logged, names: ActionNames
) -> list[str]:
    """Return the findings of a search in sentences; the first future is that of its action."""
    chosen, *further = best_first
    steps = "step" if search.transitions == 1 else "steps"
    sentences = [
        f"It simulated {search.transitions:,} {steps} before it took this one, and compared the "
        f"{search.compares}. {names.move(chosen.action).capitalize()} came first: "
        f"{in_millimetres(chosen.return_m)} in {chosen.steps} "
        f"step{'s' * (chosen.steps != 1)}, of which {in_millimetres(chosen.reward_m)} at once."
    ]
    if further:
        other = further[0]
        sentences.append(
            f"The next highest, {names.move(other.action)}, promised "
            f"{in_millimetres(other.return_m)} in {other.steps} step{'s' * (other.steps != 1)}."
        )
    missed = logged.reward_m - chosen.reward_m
    if missed == 0:
        sentences.append(f"What came is what it foresaw: {in_millimetres(logged.reward_m)}.")
    else:
        sentences.append(
            f"What came was {in_millimetres(logged.reward_m)}, {in_millimetres(abs(missed))} "
            f"{'more' if missed > 0 else 'less'} than it foresaw."
        )
    return sentences


def _choice(explained: ExplainedStep, names: ActionNames) -> ChoiceView:
    choice = explained.choice
    assert choice is not None  # noqa: S101 - the caller has checked
    sentences = _reasons(choice, names)
    if explained.chose_early:
        sentences.append("It chose so before it learned from the step before, by the values then.")
    return ChoiceView(
        kind=choice.kind,
        criterion=choice.criterion,
        scores=_rows(choice.scores),
        best=[*choice.best],
        runner_up=choice.runner_up,
        margin_m=choice.margin,
        epsilon=choice.epsilon,
        draw=choice.draw,
        probability=choice.probability,
        sentences=sentences,
    )


def _reasons(choice: ChoiceExplanation, names: ActionNames) -> list[str]:
    """Return why an action was chosen, why no other, and when another would be."""
    move, count = names.move(choice.action), int(np.isfinite(choice.scores).sum())
    sentences = []
    if choice.kind == "unknown":
        sentences.append(f"It tries {move} because it does not know yet what that brings.")
        if len(choice.best) > 1:
            sentences.append(f"{len(choice.best)} moves are as unknown; one was drawn by lot.")
        return sentences
    if choice.kind == "explored":
        sentences.append(
            f"It explores: {choice.draw:.3f} was drawn, below ε = {choice.epsilon:.3f}, so one of "
            f"{count} moves was taken by lot: {move}."
        )
        sentences.append(f"By its {choice.criterion} it would {_wanted(choice, names)}.")
        return sentences
    drawn = ""
    if choice.draw is not None:
        drawn = f", as {choice.draw:.3f} was drawn, not below ε = {choice.epsilon:.3f}"
    sentences.append(
        f"It takes what it holds for best{drawn}: {move} has the highest {choice.criterion}: "
        f"{in_millimetres(choice.scores[choice.action])}."
    )
    if len(choice.best) > 1:
        sentences.append(f"{len(choice.best)} moves are tied; one was drawn by lot.")
    elif choice.runner_up is not None and choice.margin is not None:
        sentences.append(
            f"The next best, {names.move(choice.runner_up)}, is {in_millimetres(choice.margin)} "
            "worse: were it better by more than that, it would take it."
        )
    if choice.epsilon:
        share = f"{100 * choice.probability:.0f} %"
        sentences.append(
            f"With ε = {choice.epsilon:.3f} it does this here in {share} of all cases."
        )
    return sentences


def _wanted(choice: ChoiceExplanation, names: ActionNames) -> str:
    if choice.action in choice.best:
        return "have done the same"
    if len(choice.best) > 1:
        return f"have drawn one of {len(choice.best)} tied moves"
    (best,) = choice.best
    return f"have moved {names.move(best)}, {in_millimetres(-(choice.margin or 0))} better"


def _update(explained: UpdateExplanation, names: ActionNames) -> UpdateView:
    updates = explained.others
    changed = {
        (update.observation, update.action) for update in updates if update.before != update.after
    }
    by_change = sorted(updates, key=lambda update: -abs(update.after - update.before))
    largest = by_change[:MAX_OTHERS]
    return UpdateView(
        summary=explained.summary,
        direct=None if explained.update is None else _value_update(explained.update, names),
        stored=explained.stored,
        others=OtherUpdates(
            count=len(updates),
            values_changed=len(changed),
            largest=[_value_update(update, names) for update in updates if update in largest],
        ),
        beliefs=[BeliefView(**belief._asdict()) for belief in explained.beliefs],
    )


def _value_update(update: ValueUpdate, names: ActionNames) -> ValueUpdateView:
    return ValueUpdateView(
        observation=list(update.observation),
        action=update.action,
        move=names.move(update.action),
        rule=update.rule,
        numbers=update.numbers,
        terms=[
            TermView(symbol=term.symbol, value=float(term.value), meaning=term.meaning)
            for term in update.terms
        ],
        before=update.before,
        after=update.after,
        is_exact=update.is_exact,
    )


def table_view(
    walk: WalkingProblem,
    agent: Valuing,
    table: ValueTable,
    states: Sequence[Cells],
    *,
    step: int,
    first: int,
    total: int,
) -> TableView:
    """Return values, visits and best actions of some states.

    Args:
        walk: the walking problem.
        agent: the learner.
        table: its table.
        states: observations of the states.
        step: number of steps that it has learned.
        first: index of the first of them.
        total: number of all states.
    """
    values = [agent.values(state) for state in states]
    return TableView(
        **vars(ActionNames(walk).grid),
        step=step,
        states=total,
        first=first,
        values=[_flat(row) for row in values],
        visits=[_flat(agent.visits(state)) for state in states],
        best=[_best(row) for row in values],
        landings=_landings(table),
    )


def _landings(table: ValueTable) -> LandingsView | None:
    """Return values and visits of all landings; None for another table, or one too large."""
    if not isinstance(table, LandingTable) or table.size > MAX_VALUES_SHOWN:
        return None
    _, values, visits = zip(*table.rows(), strict=True)
    return LandingsView(values=list(values), visits=list(visits))


def _best(values: FloatArray) -> Action:
    """Return the first action with the highest value."""
    return Action(*map(int, np.unravel_index(np.nanargmax(values), values.shape)))


def _flat(values: FloatArray) -> list[float | None]:
    return [_number(value) for value in values.ravel().tolist()]


def _rows(values: FloatArray) -> list[list[float | None]]:
    return [[_number(value) for value in row] for row in values.tolist()]


def _number(value: float) -> float | None:
    """Return a number, None for NaN, which JSON lacks."""
    return float(value) if math.isfinite(value) else None
