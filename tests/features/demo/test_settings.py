"""Settings of a demo: what is stricter then, and what is refused."""

import pytest

from app.features.demo.settings import DemoSettings
from app.settings import read_settings
from hexapods.domain.errors import InvalidInput

TOKEN = "a-token-for-tests"


def test_a_demo_has_stricter_defaults_that_settings_override() -> None:
    environ = {"HEXAPODS_DEMO": "yes", "HEXAPODS_TOKEN": TOKEN}
    demo, usual = read_settings(environ), read_settings({})
    assert demo.of(DemoSettings).demo
    assert demo.starts_per_minute < usual.starts_per_minute
    assert demo.max_viewers < usual.max_viewers
    assert demo.quota_mb == 4000
    changed = read_settings(
        {**environ, "HEXAPODS_QUOTA_MB": "90", "HEXAPODS_STARTS_PER_MINUTE": "7"}
    )
    assert (changed.quota_mb, changed.starts_per_minute) == (90, 7)
    assert not read_settings({"HEXAPODS_DEMO": "0"}).of(DemoSettings).demo


def test_an_option_turns_it_on() -> None:
    settings = read_settings({}, demo=True, token=TOKEN, demo_hours=2)
    assert settings.of(DemoSettings) == DemoSettings(demo=True, demo_hours=2)
    assert settings.quota_mb == 4000


@pytest.mark.parametrize(
    ("environ", "words"),
    [
        ({"DEMO": "1"}, ["HEXAPODS_TOKEN", "stranger"]),
        ({"DEMO": "1", "HOST": "0.0.0.0"}, ["HEXAPODS_TOKEN"]),
        (
            {"DEMO": "1", "TOKEN": TOKEN, "WITHOUT": "demo"},
            ["HEXAPODS_DEMO is on", "leaves the demo out, so that", "one of both"],
        ),
        ({"DEMO": "perhaps"}, ["HEXAPODS_DEMO", "1 or 0"]),
        ({"DEMO": "1", "TOKEN": TOKEN, "SPECTATORS": "token"}, ["HEXAPODS_SPECTATORS"]),
        ({"DEMO": "1", "TOKEN": TOKEN, "DEMO_HOURS": "25"}, ["from 1 to 24"]),
        ({"DEMO": "1", "TOKEN": TOKEN, "DEMO_STEPS_PER_HOUR": "0"}, ["at least 1"]),
    ],
    ids=str,
)
def test_invalid_settings_of_a_demo_are_refused(environ: dict[str, str], words: list[str]) -> None:
    with pytest.raises(InvalidInput) as error:
        read_settings({f"HEXAPODS_{name}": value for name, value in environ.items()})
    assert all(word in str(error.value) for word in words)


def test_a_demo_that_is_left_out_is_off() -> None:
    without = {"HEXAPODS_WITHOUT": "demo", "HEXAPODS_DEMO": "0", "HEXAPODS_DEMO_HOURS": "3"}
    assert read_settings(without).without == ("demo",)
