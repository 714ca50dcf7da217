"""YAML as plain values: what JSON has, and nothing that a person would not expect."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hexapods.domain.errors import InvalidInput
from hexapods.domain.plain_yaml import read_plain, write_plain

WORDS = ["no", "yes", "on", "~", "null", "1", "0.5", "1e3", "2026-01-01", "", " a", "a: b", "- x"]
TEXT = st.text(st.characters(codec="utf-8", exclude_categories=["Cc", "Cs"]), max_size=20)
PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**9), 10**9) | TEXT | st.sampled_from(WORDS),
    lambda values: st.lists(values, max_size=3) | st.dictionaries(TEXT, values, max_size=3),
    max_leaves=8,
)


@pytest.mark.test
@given(PLAIN)
def test_plain_values_round_trip_through_yaml(value: object) -> None:
    assert read_plain(write_plain(value).encode(), "x", "lesson") == value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("{a: no, b: true, c: null, d: 0.50, e: -3, f: 2026-01-01, g: 0x10}", None),
        ("a: |\n  one\n  two\n", {"a": "one\ntwo\n"}),
    ],
)
def test_plain_scalars_are_read_as_in_json(text: str, value: object) -> None:
    expected = value or {
        "a": "no", "b": True, "c": None, "d": 0.5, "e": -3, "f": "2026-01-01", "g": "0x10"
    }  # fmt: skip
    assert read_plain(text.encode(), "x", "lesson") == expected


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: &x [1]\nb: *x\n", "x, line 2: not valid YAML: *x: aliases are not read"),
        ("!!python/name:os.system x", "x, line 1: the tag 'python/name:os.system' is not read"),
        ("!!int many", "does not fit its tag"),
        ("{[a]: 1}", "a name is a word"),
        ("a: 1\na: 2\n", "line 2: 'a' is given twice"),
        ("a: <<\n<<: {b: 1}\n", ""),
        ("[" * 30 + "]" * 30, "nested too deeply"),
        ("k: 1\n" * 25_000, "line 5000: not valid YAML: it has more than 10,000 names and values"),
        ("{" + "a," * 130_000, "it has more than 10,000 names and values"),
        ("[" + "1," * 130_000 + "]", "it has more than 10,000 names and values"),
    ],
)
def test_yaml_that_is_refused_is_reported_with_its_line(text: str, words: str) -> None:
    if not words:  # a merge key is a name like any other
        assert read_plain(text.encode(), "x", "lesson") == {"a": "<<", "<<": {"b": 1}}
        return
    with pytest.raises(InvalidInput) as refused:
        read_plain(text.encode(), "x", "lesson")
    assert words in str(refused.value)
