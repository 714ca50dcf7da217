"""The allowance by itself: what is refused of a start, and in which words."""

import pytest

from app.features.demo.allowance import Allowance, in_words
from app.features.demo.settings import DemoSettings
from app.settings import read_settings
from app.storage.errors import Busy, Forbidden
from app.storage.run import Run
from hexapods.domain.errors import InvalidInput
from hexapods.experiments.config import ExperimentConfig
from tests.jobs.test_jobs import training

ALLOWANCE = Allowance()


def run_of(steps: int) -> Run:
    return Run(id="a", kind="training", name="x", config=training().config, total=steps)


def test_a_start_is_as_long_as_it_may_be_and_no_longer() -> None:
    most = ALLOWANCE.steps_per_start
    ALLOWANCE.check_start([run_of(most - 200), run_of(200)])
    with pytest.raises(InvalidInput, match=r"up to 10,000 steps at once.*this has 100,000"):
        ALLOWANCE.check_start([run_of(100_000)])
    with pytest.raises(InvalidInput, match="up to 300 steps"):
        Allowance(steps_per_hour=300).check_start([run_of(301)])


def test_short_starts_count_as_the_least() -> None:
    assert ALLOWANCE.cost([run_of(1)]) == ALLOWANCE.least_steps
    assert ALLOWANCE.cost([run_of(500), run_of(200)]) == 700


def test_experiments_are_the_operators() -> None:
    config = ExperimentConfig(experiment="sweep")
    experiment = Run(id="a", kind="experiment", name="x", config=config, total=5)
    with pytest.raises(Forbidden, match="experiments need the operator"):
        ALLOWANCE.check_start([experiment])


def test_refusals_say_what_is_allowed_and_when() -> None:
    ALLOWANCE.check_unended(1, 63)
    with pytest.raises(Busy, match="2 of your runs wait or go on, and 2 may at once"):
        ALLOWANCE.check_unended(2, 2)
    with pytest.raises(Busy, match="64 runs of visitors of your network"):
        ALLOWANCE.check_unended(0, 64)
    ALLOWANCE.check_kept(38, 2, 60)
    with pytest.raises(
        Busy, match=r"40 may be kept here; delete some, or wait: .* in 2 h"
    ) as refused:
        ALLOWANCE.check_kept(39, 2, 7200)
    assert refused.value.retry_after_s == 7200
    used_up = ALLOWANCE.used_up(700, 300, 754.2)
    assert used_up.retry_after_s == 755
    assert "300 of 20,000 steps an hour left" in str(used_up)
    assert str(used_up).endswith("start it in 13 min")
    assert "640,000" in str(ALLOWANCE.address_used_up(30))


def test_times_in_words() -> None:
    seconds = (0.2, 40, 99, 100, 3600, 7000, 86_400)
    words = ["in 1 s", "in 40 s", "in 99 s", "in 2 min", "in 60 min", "in 2 h", "in 24 h"]
    assert [in_words(duration) for duration in seconds] == words


def test_operators_choose_steps_and_hours() -> None:
    environ = {
        "HEXAPODS_DEMO": "1",
        "HEXAPODS_TOKEN": "a-token-for-tests",
        "HEXAPODS_DEMO_STEPS_PER_HOUR": "3000",
        "HEXAPODS_DEMO_HOURS": "2",
    }
    chosen = Allowance.of(read_settings(environ).of(DemoSettings))
    assert (chosen.steps_per_hour, chosen.lifetime.total_seconds()) == (3000, 7200)
    assert chosen.steps_per_hour_of_address == 96_000
