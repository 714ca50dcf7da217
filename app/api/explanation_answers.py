"""Response models of explained steps and of tables, as `answers` has those of runs."""

from typing import Annotated, Literal

from pydantic import Field

from app.api.answers import Answer, Count

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
    """Why an action was chosen, why no other, and when another would have been."""

    kind: Annotated[
        Literal["exploited", "explored", "unknown"],
        Field(description="the best by its scores, a random one, or one that is not known yet"),
    ]
    criterion: Annotated[str, Field(description="what its scores are")]
    scores: Values
    best: list[Move]
    runner_up: Move | None
    margin_m: Annotated[
        float | None, Field(description="score of the action, less that of the runner-up")
    ]
    epsilon: Annotated[float | None, Field(description="probability of a random action")]
    draw: Annotated[float | None, Field(description="random number that was compared with it")]
    probability: Annotated[float, Field(ge=0, le=1, description="of this action in this state")]
    sentences: list[str]


class TermView(Answer):
    """A number in a rule."""

    symbol: str
    value: float
    meaning: str


class ValueUpdateView(Answer):
    """Update of one value: the rule gives the value after it, to the last bit."""

    observation: list[Cell]
    action: Move
    move: str
    rule: str
    numbers: Annotated[str, Field(description="the rule with rounded numbers put in")]
    terms: list[TermView]
    before: float
    after: float
    is_exact: Annotated[bool, Field(description="whether the rule was checked and gives `after`")]


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
    """Update of the learner's values by a step."""

    summary: str
    direct: ValueUpdateView | None
    stored: Annotated[
        float | None, Field(description="the value in the end, as planning may change it again")
    ]
    others: OtherUpdates
    beliefs: list[BeliefView]


class FutureView(Answer):
    """Finding of a search about an action."""

    action: Move
    reward_m: Annotated[float, Field(description="of the step, as simulated")]
    return_m: Annotated[float, Field(description="what the search compared")]
    sequences: Annotated[Count, Field(description="simulated ones that begin with it")]
    steps: Annotated[Count, Field(description="how far these look ahead")]


class SearchView(Answer):
    """Simulations of a search, with the outcome of each future; its action comes first."""

    compares: str
    transitions: Count
    futures: list[FutureView]
    sentences: list[str]


class ExplanationView(WalkedGrid):
    """An explained step."""

    run_id: str
    lane: int | None
    step: Annotated[int, Field(ge=1)]
    agent: str
    observation: list[Cell]
    action: Move
    reward_m: float
    next_observation: list[Cell] | None
    visits: Annotated[
        list[list[float | None]] | None,
        Field(description="how often each move had been tried here before, by leg pair and cell"),
    ]
    choice: ChoiceView | None
    update: Annotated[UpdateView | None, Field(description="null if it learned nothing from it")]
    search: Annotated[SearchView | None, Field(description="null if it does not search")]
    unexplained: Annotated[str | None, Field(description="why the choice is not explained")]


class TableView(WalkedGrid):
    """Values, visits and best actions of states: a row a state, in the order of their cells."""

    step: Count
    states: Annotated[int, Field(ge=1, description="number of all states")]
    first: Count
    values: Annotated[
        list[list[float | None]],
        Field(description="action values [m], pair by pair; null where illegal"),
    ]
    visits: Annotated[
        list[list[float | None]],
        Field(description="how often each was tried; a value without a try is no estimate"),
    ]
    best: list[Move]
