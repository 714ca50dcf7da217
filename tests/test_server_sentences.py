"""Sentences of the server, each as it can be, come out whole in every language of the page.

They are made here as the server makes them. One of the catalogues is English in full-width letters:
a letter of ASCII that is left was not looked up.
"""

import re
from collections.abc import Iterator, Sequence
from itertools import product
from typing import Literal, get_args

import numpy as np
import pytest

from app.features.explanations.loss import (
    PassedOver,
    Tried,
    about_better,
    about_steps,
    about_table,
)
from app.features.explanations.names import ActionNames
from app.features.explanations.sentences import SearchFindings, sentences_of
from app.storage.run_names import branch_name, race_name, training_name
from hexapods import assets
from hexapods.agents.appearance import title_of
from hexapods.agents.experts import MeasuredExpert, PlannedExpert
from hexapods.agents.explanation import ChoiceExplanation, Future
from hexapods.agents.registry import compares, registered
from hexapods.assembly import build_learner
from hexapods.domain.types import Action
from hexapods.domain.world import WORLDS
from hexapods.runs.config import training_config
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.rebuilding import ExplainedStep
from hexapods.runs.transition_log import Logged
from tests.agents.test_explanation import LEARNERS, explained
from tests.agents.test_explanation import ExplainedStep as LearnersStep
from tests.server_sentences import (
    FULL_WIDTH,
    Said,
    english_left,
    keys,
    refusals_in,
    said,
    texts_in,
    without_names,
)

NAMES = ("Q-learning", "Greedy", "Two-step", "Look-ahead")
MADE = Action(0, 1)
OWN = "random-walk"
"""It does not say what it compares, as a search of one's own may not."""
GAIT = "left-right-origin"
GROUPS, CELLS = 3, 5


def step(
    choice: ChoiceExplanation | None, reward_m: float, tries: int | None, *, early: bool = False
) -> ExplainedStep:
    visits = np.zeros((GROUPS, CELLS))
    visits[MADE] = tries or 0
    logged = Logged((0, 0, 0), (), MADE, reward_m, (1, 0, 0), ())
    return ExplainedStep(1, logged, None if tries is None else visits, choice, None, early)


def choices(criterion: str) -> Iterator[ChoiceExplanation]:
    """Yield a choice of each kind."""
    tied, alone, other = (np.zeros((GROUPS, CELLS)) for _ in range(3))
    tied[MADE] = tied[1, 2] = 0.0123
    alone[MADE], other[1, 2] = 0.0123, 0.0123
    only = np.full((GROUPS, CELLS), np.nan)
    only[MADE] = 0.0123
    for scores, draw in product((tied, alone, only), (None, 0.532)):
        yield ChoiceExplanation(MADE, "exploited", criterion, scores, 0.1, draw)
    others = other.copy()
    others[2, 3] = 0.0123
    for scores in (tied, alone, other, others):
        yield ChoiceExplanation(MADE, "explored", criterion, scores, 0.5, 0.123)
    for scores in (tied, alone):
        yield ChoiceExplanation(MADE, "unknown", criterion, scores)


def criteria() -> set[str]:
    """Return what learners go by in their practice, as their choices say it."""
    steps = [step for agent in (*LEARNERS, "tamer") for step in explained(agent)]
    learner = build_learner(
        training_config("linear-model", simulator="kinematic", steps=400, order="cycles", gait=GAIT)
    )
    steps += [LearnersStep(learner) for _ in range(400)]
    found = {step.choice.criterion for step in steps if step.choice is not None}
    # Feet are as planned where nothing slips, so that it goes by one of its two models.
    return found | {text.replace(PlannedExpert.name, MeasuredExpert.name) for text in found}


def why_sentences() -> Iterator[str]:
    """Yield what is said of steps: of learners, and of searches."""
    names = ActionNames(training_config("q-learning"))
    parts = [
        sentences_of(step(None, reward_m, tries), None, names)
        for reward_m, tries in product((0.0123, -0.0123), (None, 0, 1, 1200))
    ]
    parts += [
        sentences_of(step(choice, 0.0123, tries, early=early), None, names)
        for criterion in criteria()
        for choice in choices(criterion)
        for tries, early in product((None, 3), (False, True))
    ]
    for agent, steps in product(("greedy", "mcts", "informed", OWN), (1, 2)):
        first = Future(MADE, 0.01, 0.0246, 4, steps)
        level = first._replace(action=Action(1, 2))
        for reward_m, more in product(
            (0.01, 0.02, 0.005), ([], [level], [level._replace(return_m=0.02)])
        ):
            search = SearchFindings(compares(agent), 1500, [first, *more])
            parts.append(sentences_of(step(None, reward_m, None), search, names))
            yield search.compares
    yield from criteria()
    finer = ActionNames(training_config("q-learning", divisions=3))
    yield from (finer.move(Action(0, cell)) for cell in range(len(finer.grid.cells_m)))
    for sentences in parts:
        yield from filter(None, (sentences.what, sentences.why, sentences.missed))


def loss_sentences() -> Iterator[str]:
    """Yield what is said of a learner with a table that loses."""
    tables: Sequence[Literal["moves", "landings"]] = ("moves", "landings")
    for kind, states, practised in product(tables, (1, 12), (None, 1, 20_000)):
        yield about_table(Tried(12_500, 36_000, kind, states, 3, 36), practised)
    kinds = get_args(PassedOver)
    for steps, numbers in product((1, 50), product((0, 1, 12), repeat=len(kinds))):
        yield about_steps(steps, -0.0012, 0.0246)
        yield about_better(
            steps, sum(numbers), dict(zip(kinds, numbers, strict=True))
        )  # whole numbers


def run_names() -> Iterator[str]:
    """Yield names that the server gives runs."""
    for named in WORLDS.values():
        practice = training_config("q-learning", world=named.world, seed=12)
        yield training_name(practice)
        yield training_name(practice, is_continued=True)
        lanes = tuple(LaneConfig(agent=agent) for agent in ("greedy", "two-step"))
        race = race_name(RaceConfig(lanes=lanes, world=named.world))
        yield race
        yield branch_name(race, 12)


_CLASSROOM = "app/features/classroom"
REFUSING = [
    f"{_CLASSROOM}/{name}.py"
    for name in ("press_book", "room", "room_registry", "room_runs", "rooms", "seats", "teaching")
]
"""Modules whose refusals a phone can meet, all of them."""
OTHERS = [
    *(f"{_CLASSROOM}/{name}.py" for name in ("card_starts", "pages", "participant_routes")),
    *(f"{_CLASSROOM}/{name}.py" for name in ("questions", "room_routes")),
    *("app/features/demo/allowance.py", "app/features/explanations/loss.py"),
    *("app/features/explanations/rebuilt_practice.py", "app/features/explanations/service.py"),
    *("app/api/concurrency_limit.py", "app/api/rate_limit.py", "app/jobs/jobs.py"),
    *("app/jobs/queue.py", "app/jobs/stopping.py", "app/jobs/supervisor.py"),
    *("app/storage/artifacts.py", "app/storage/disk_space.py"),
]
"""Modules of which a phone or Watch can meet some."""


def source(module: str) -> str:
    return (assets.static_dir().parent / module).read_text("utf-8")


@pytest.fixture(scope="module")
def all_said() -> Said:
    return said([*why_sentences(), *loss_sentences()], run_names())


def test_a_sentence_comes_out_whole(all_said: Said) -> None:
    in_full_width = all_said.by_language[FULL_WIDTH]
    left = {text: english_left(text, NAMES) for text in in_full_width.values()}

    assert len(in_full_width) > 200
    assert {text: words for text, words in left.items() if words} == {}


def test_no_language_has_a_sentence_that_the_server_does_not_say(all_said: Said) -> None:
    errors = set().union(*(texts_in(source(module)) for module in (*REFUSING, *OTHERS)))
    unused = {key for key in keys("de") - all_said.used if without_names(key) not in errors}

    assert unused == set()
    for language in all_said.by_language.keys() - {FULL_WIDTH}:
        assert keys(language) == keys("de")


def test_every_refusal_of_a_room_is_there() -> None:
    refusals = set().union(*(refusals_in(source(module)) for module in REFUSING))

    assert len(refusals) > 20
    assert refusals - {without_names(key) for key in keys("de")} == set()


def test_agents_have_one_name_in_all_languages() -> None:
    """It is also in the names of lanes, which races store."""
    titles = {title_of(name) for name in registered()}

    for language in ("de", "fr"):
        assert titles & (keys(language, "server") | keys(language, "page")) == set()


def test_numbers_are_those_of_the_page(all_said: Said) -> None:
    german = all_said.by_language["de"]

    assert (
        german["The step brought 12.3 mm forward."] == "Der Schritt brachte 12,3\u00a0mm nach vorn."
    )
    assert "12\u202f500 der 36\u202f000 Bewegungen" in next(
        text for text in german.values() if text.startswith("In 20\u202f000 Übungsschritten")
    )
    assert not [text for text in german.values() if re.search(r"\d\.\d", text)]
