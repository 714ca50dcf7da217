"""The examples in the docstrings of the functions of `hx`: each has one, and they run."""

import doctest
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import hexapods as hx
from hexapods.domain.robot import document_of, robot

FUNCTIONS = {name: getattr(hx, name) for name in dir(hx) if inspect.isfunction(getattr(hx, name))}
WITH_PROCESSES = ("benchmark", "experiment")


def examples_of(function: Callable[..., Any]) -> doctest.DocTest:
    """Return the examples of a function, which see no names but those that they import."""
    name, text = function.__name__, inspect.getdoc(function) or ""
    file = inspect.getsourcefile(function)
    return doctest.DocTestParser().get_doctest(text, {"__name__": name}, name, file, 0)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.test if name in WITH_PROCESSES else ())
        for name in FUNCTIONS
    ],
)
def test_the_example_of_a_function_runs(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    # As `hexapods robots export dog --out dog.json` writes it.
    Path("dog.json").write_bytes(document_of(robot("dog")))
    examples, report = examples_of(FUNCTIONS[name]), list[str]()
    outcome = doctest.DocTestRunner().run(examples, out=report.append)
    assert outcome.failed == 0, "".join(report)
    assert any(f"hx.{name}(" in example.source for example in examples.examples)


def test_a_result_that_is_another_one_is_found() -> None:
    def recommend() -> None:
        """Recommend a learner.

        >>> import hexapods as hx
        >>> hx.recommended_agent("dog", "bound")
        'linear-model'
        """

    outcome = doctest.DocTestRunner().run(examples_of(recommend), out=lambda _: None)
    assert (outcome.attempted, outcome.failed) == (2, 1)
