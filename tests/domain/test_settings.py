"""Declared settings: discovery in signatures and dataclasses, validation, parsing, formatting."""

import math
import pickle
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, Literal

import pytest
from annotated_types import Ge, Gt, Le, Lt

from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.settings import (
    REQUIRED,
    Setting,
    SettingValues,
    complete,
    declare,
    declared_fields,
    declared_parameters,
    takes_any,
)

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


def test_declared_parameters_are_settings() -> None:
    parameters = declared_parameters(Agent)
    assert list(parameters) == ["rate", "count"]
    assert (parameters["rate"].default, parameters["count"].default) == (0.3, REQUIRED)
    assert parameters["rate"].about is ABOUT


def test_settings_are_found_in_dataclasses_and_functions() -> None:
    assert list(declared_fields(Config)) == ["pace"]
    assert list(declared_parameters(Agent.__init__)) == ["rate", "count"]


class Extended(Agent):
    def __init__(self, *args: Any, width: Annotated[int, Ge(1), ABOUT] = 3, **options: Any) -> None:
        super().__init__(*args, **options)
        self.width = width


class Closed(Agent):
    def __init__(self, width: Annotated[int, Ge(1), ABOUT] = 3) -> None:
        super().__init__(None, count=width)


def test_parameters_of_a_base_class_are_found_where_others_are_passed_on() -> None:
    assert list(declared_parameters(Extended)) == ["rate", "count", "width"]
    assert list(declared_parameters(Closed)) == ["width"]
    assert not takes_any(Extended)
    assert takes_any(lambda **changes: changes)


def test_one_annotation_that_cannot_be_resolved_hides_no_other() -> None:
    def build(
        rng: "Undefined",  # type: ignore[name-defined]  # noqa: F821
        rate: Annotated[float, Gt(0), ABOUT] = 1.0,
    ) -> None:
        pass

    assert declared_parameters(build)["rate"].valid == "a number over 0"
    assert declared_parameters(partial(build, 1))["rate"].valid == "a number over 0"


def test_values_of_settings_are_complete_checked_and_hashable() -> None:
    values = complete({"rate": RATE, "count": COUNT}, {"count": 2.0, "rate": 1}, "it")
    assert dict(values) == {"rate": 1.0, "count": 2}
    assert (type(values["rate"]), type(values["count"])) == (float, int)
    assert hash(values) == hash(SettingValues({"count": 2, "rate": 1.0}))
    assert pickle.loads(pickle.dumps(values)) == values
    assert values | {"rate": 0.5} == SettingValues({"rate": 0.5, "count": 2})
    with pytest.raises(UnknownName, match="unknown setting of it 'mass'; choose one of: rate"):
        complete({"rate": RATE}, {"mass": 1}, "it")
    with pytest.raises(InvalidInput, match="it needs rate, a number over 0"):
        complete({"rate": RATE}, {}, "it")
    with pytest.raises(InvalidInput, match="rate must be a number over 0"):
        complete({"rate": RATE}, {"rate": 10**400}, "it")


@pytest.mark.parametrize("values", [{"a b": 1}, {"x": float("nan")}, {"x": {}}, {"x" * 61: 1}])
def test_values_that_are_not_plain_are_refused(values: dict[str, Any]) -> None:
    with pytest.raises(InvalidInput):
        SettingValues(values)


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
