"""Declared settings: discovery in signatures and dataclasses, validation, parsing, formatting."""

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import pytest
from annotated_types import Ge, Gt, Le, Lt

from app.domain.errors import InvalidInput
from app.domain.settings import REQUIRED, Setting, declare, declared_fields, declared_parameters

ABOUT = Setting(title="A title", help="A sentence.", symbol="α", live=True)


class Agent:
    def __init__(
        self,
        rng: object,
        rate: Annotated[float, Gt(0), Le(1), ABOUT] = 0.3,
        *,
        steps: int = 5,
        count: Annotated[int, Ge(1), ABOUT],
    ) -> None:
        pass


@dataclass
class Config:
    pace: Annotated[Literal["max"] | Annotated[float, Ge(0.01), Le(1000)], ABOUT] = "max"
    name: str = ""


def test_parameters_of_plain_type_with_a_default_are_settings() -> None:
    found = declared_parameters(Agent)
    assert list(found) == ["rate", "steps", "count"]
    assert (found["steps"].valid, found["steps"].about.title) == ("a whole number", "Steps")
    assert (found["rate"].default, found["count"].default) == (0.3, REQUIRED)
    assert found["rate"].about is ABOUT


def test_settings_are_found_in_dataclasses_and_functions() -> None:
    assert list(declared_fields(Config)) == ["pace"]
    assert list(declared_parameters(Agent.__init__)) == ["rate", "steps", "count"]


@pytest.mark.parametrize(
    ("annotation", "words"),
    [
        (Annotated[float, Gt(0), Le(1)], "a number over 0 and at most 1"),
        (Annotated[float, Gt(0), Lt(1)], "a number over 0 and under 1"),
        (Annotated[float, Ge(0), Lt(1)], "a number from 0 to under 1"),
        (Annotated[float, Ge(0.01), Le(1)], "a number from 0.01 to 1"),
        (Annotated[float, Gt(0)], "a number over 0"),
        (Annotated[int, Ge(0)], "a whole number of at least 0"),
        (Annotated[int, Lt(10)], "a whole number under 10"),
        (Annotated[int, Le(10)], "a whole number of at most 10"),
        (Annotated[int, Ge(1), Le(10_000_000)], "a whole number from 1 to 10,000,000"),
        (Annotated[float, None], "a number"),
        (Annotated[bool, None], "true or false"),
        (Annotated[str, None], "text of at most 200 characters"),
        (Annotated[Literal["a", "b"], None], "a, or b"),
        (
            Annotated[Literal["max"] | Annotated[float, Ge(1)], None],
            "max, or a number of at least 1",
        ),
        (Annotated[float | None, Ge(0), Le(1)], "a number from 0 to 1"),
    ],
)
def test_valid_values_are_described(annotation: Any, words: str) -> None:
    assert declare("x", Annotated[annotation, ABOUT]).valid == words


RATE = declare("rate", Annotated[float, Gt(0), Le(1), ABOUT])
COUNT = declare("count", Annotated[int, Ge(1), Lt(10), ABOUT])
PACE = declared_fields(Config)["pace"]
OPTIONAL = declare("share", Annotated[float | None, Ge(0), Le(1), ABOUT])
SWITCH = declare("switch", Annotated[bool, ABOUT])


@pytest.mark.parametrize(
    ("setting", "value"),
    [
        (RATE, 1),
        (RATE, 0.3),
        (COUNT, 9),
        (PACE, "max"),
        (PACE, 2),
        (OPTIONAL, None),
        (SWITCH, True),
    ],
)
def test_valid_values_pass(setting: Any, value: Any) -> None:
    setting.check(value)


@pytest.mark.parametrize(
    ("setting", "value"),
    [
        (RATE, 0),
        (RATE, 1.1),
        (RATE, math.nan),
        (RATE, True),
        (RATE, "0.3"),
        (RATE, None),
        (COUNT, 0),
        (COUNT, 10),
        (COUNT, 2.0),
        (COUNT, 10**400),
        (PACE, "min"),
        (PACE, math.inf),
        (OPTIONAL, 2),
        (SWITCH, 1),
    ],
)
def test_invalid_values_are_refused_with_name_and_valid_values(setting: Any, value: Any) -> None:
    with pytest.raises(InvalidInput) as error:
        setting.check(value)
    assert str(error.value).startswith(f"{setting.name} must be {setting.valid}, not ")


@pytest.mark.parametrize(
    ("setting", "text", "value"),
    [
        (RATE, "1", 1.0),
        (COUNT, "3", 3),
        (PACE, "max", "max"),
        (PACE, "2", 2.0),
        (SWITCH, "true", True),
    ],
)
def test_text_is_parsed_to_the_type_of_the_setting(setting: Any, text: str, value: object) -> None:
    parsed = setting.parse(text)
    assert (parsed, type(parsed)) == (value, type(value))


@pytest.mark.parametrize(
    ("setting", "text"), [(RATE, "a"), (RATE, "nan"), (COUNT, "1.5"), (PACE, ""), (SWITCH, "1")]
)
def test_invalid_text_is_refused(setting: Any, text: str) -> None:
    with pytest.raises(InvalidInput, match=f"{setting.name} must be"):
        setting.parse(text)
