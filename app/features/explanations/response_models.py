"""Response models of explained steps and of tables, as `answers` has those of runs."""

from typing import Annotated, Literal

from pydantic import Field

from app.answer import Answer, Count
from hexapods.runs.clocks import Clock

Cell = Annotated[int, Field(ge=0, description="cell of the foot grid; 0 is home")]
Move = Annotated[
    tuple[int, int], Field(description="leg pair and cell to which it moves, both from 0 on")
]
Values = Annotated[
    list[list[float | None]],
    Field(description="by leg pair and cell [m]; null where it could not be chosen"),
]


class WalkedGrid(Answer):
    """Leg pairs, and cells of the foot grid with their names."""

    pairs: list[list[int]]
    cells_m: list[tuple[float, float]]
    cell_names: list[str]


class ChoiceView(Answer):
    """Why an action was chosen, why no other, and when another would have been.

    Attributes:
        kind: the best by its scores, a random one, or one that is not known yet.
        criterion: what its scores are.
        margin_m: score of the action, less that of the runner-up.
        epsilon: probability of a random action.
        draw: random number that was compared with it.
        probability: of this action in this state.
    """

    kind: Literal["exploited", "explored", "unknown"]
    criterion: str
    scores: Values
    best: list[Move]
    runner_up: Move | None
    margin_m: float | None
    epsilon: float | None
    draw: float | None
    probability: Annotated[float, Field(ge=0, le=1)]


class TermView(Answer):
    """A number in a rule."""

    symbol: str
    value: float
    meaning: str


class ValueUpdateView(Answer):
    """Update of one value: the rule gives the value after it, to the last bit.

    Attributes:
        numbers: the rule with rounded numbers put in.
        is_exact: whether the rule was checked and gives `after`.
    """

    observation: list[Cell]
    action: Move
    move: str
    rule: str
    numbers: str
    terms: list[TermView]
    before: float
    after: float
    is_exact: bool


class OtherUpdates(Answer):
    """Further updates by the same step: planned ones, and those of earlier steps."""

    count: Count
    values_changed: Count
    largest: list[ValueUpdateView]


class BeliefView(Answer):
    """Beliefs of a model, before and after the step."""

    name: str
    unit: str
    before: float
    after: float
    deviation_before: float | None
    deviation_after: float | None


class UpdateView(Answer):
    """Update of the learner's values by a step.

    Attributes:
        stored: the value in the end, as planning may change it again.
    """

    summary: str
    direct: ValueUpdateView | None
    stored: float | None
    others: OtherUpdates
    beliefs: list[BeliefView]


class FutureView(Answer):
    """Finding of a search about an action.

    Attributes:
        reward_m: of the step, as simulated.
        return_m: what the search compared.
        sequences: simulated ones that begin with it.
        steps: how far these look ahead.
    """

    action: Move
    reward_m: float
    return_m: float
    sequences: Count
    steps: Count


class SearchView(Answer):
    """Simulations of a search, with the outcome of each future; its action comes first."""

    compares: str
    transitions: Count
    futures: list[FutureView]


class ExplanationView(WalkedGrid):
    """An explained step.

    Attributes:
        visits: how often each move had been tried here before, by leg pair and cell.
        update: null if it learned nothing from it.
        search: null if it does not search.
        unexplained: why the choice is not explained.
        what: in a sentence what the step brought, and how often its move had been tried here.
        why: in a sentence why this move was made; null where the choice is not explained.
        missed: in a sentence what it passed over or did not see; null where the choice is not
            explained.
    """

    run_id: str
    lane: int | None
    step: Annotated[int, Field(ge=1)]
    agent: str
    observation: list[Cell]
    action: Move
    reward_m: float
    next_observation: list[Cell] | None
    visits: list[list[float | None]] | None
    choice: ChoiceView | None
    update: UpdateView | None
    search: SearchView | None
    unexplained: str | None
    what: str
    why: str | None
    missed: str | None


class LandingsView(Answer):
    """Values [m] and visits of all landings, in the order of their cells."""

    values: list[float]
    visits: list[Count]


class LossView(Answer):
    """Why a learner with a table loses a race: in numbers, and in three sentences.

    Attributes:
        is_ranked: whether the race has timed out; if not, lanes are compared as they are now.
        ahead: lane that is ahead of all others.
        behind_m: how far this lane is behind that one.
        steps: of the lane so far, each of which was simulated with every other move.
        practised_steps: before the race; null if a training of them was deleted.
        tried: moves, or landings, of the table that it had tried when it took its last step.
        entries: in the table, and of what kind they are.
        states: different ones that it walked through.
        tried_there: moves of these states that it had tried.
        moves_there: in these states.
        reward_m: what a step brought, on average.
        best_reward_m: what the best moves would have brought, one step ahead.
        better_by_m: how much more the best move has to bring to count as better.
        better: steps in which the best move was better; the next three tell why it was not made.
        untried: it had never tried it.
        undervalued: its table held it for worse than the move that it made.
        not_chosen: its table held it for no worse, and it made another.
    """

    run_id: str
    lane: Count
    agent: str
    clock: Clock
    is_ranked: bool
    ahead: Count
    behind_m: float
    steps: Count
    practised_steps: Count | None
    tried: Count
    entries: Count
    kind: Literal["moves", "landings"]
    states: Count
    tried_there: Count
    moves_there: Count
    reward_m: float
    best_reward_m: float
    better_by_m: float
    better: Count
    untried: Count
    undervalued: Count
    not_chosen: Count
    sentences: Annotated[list[str], Field(min_length=3, max_length=3)]


class TableView(WalkedGrid):
    """Values, visits and best actions of states: a row a state, in the order of their cells.

    Attributes:
        states: number of all states.
        values: action values [m], pair by pair; null where illegal.
        visits: how often each was tried; a value without a try is no estimate.
        landings: of a learner that keeps one value for each landing, which all actions share that
            end with the feet there; null for others, and where there are too many for an answer.
    """

    step: Count
    states: Annotated[int, Field(ge=1)]
    first: Count
    values: list[list[float | None]]
    visits: list[list[float | None]]
    best: list[Move]
    landings: LandingsView | None
