"""Explanations and tables as the API responds with them."""

import math
from collections.abc import Sequence

import numpy as np

from app.features.explanations.names import ActionNames
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
)
from app.features.explanations.sentences import SearchFindings, futures_in_order, sentences_of
from hexapods.agents.explanation import (
    ChoiceExplanation,
    UpdateExplanation,
    ValueUpdate,
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


def explanation_view(
    run_id: str,
    walk: WalkingProblem,
    agent: str,
    explained: ExplainedStep,
    *,
    lane: int | None = None,
    search: SearchFindings | None = None,
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
        choice=None if explained.choice is None else _choice(explained.choice),
        update=None if explained.update is None else _update(explained.update, names),
        search=None if search is None else _search(search, logged),
        unexplained=unexplained,
        **vars(sentences_of(explained, search, names)),
    )


def _search(search: SearchFindings, logged: Logged) -> SearchView:
    return SearchView(
        compares=search.compares,
        transitions=search.transitions,
        futures=[
            FutureView(**future._asdict()) for future in futures_in_order(search, logged.action)
        ],
    )


def _choice(choice: ChoiceExplanation) -> ChoiceView:
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
    )


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
