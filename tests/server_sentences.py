"""What the page makes of sentences of the server in other languages, as its scripts say them."""

import ast
import json
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence, Set
from functools import cache
from pathlib import Path
from typing import NamedTuple

from app.api.descriptions import as_sentence
from hexapods import assets

FULL_WIDTH = "full width"
"""A catalogue whose texts are the English ones in full-width letters."""
_SCRIPT = "tests/page/say.js"
_FIGURES = frozenset({"mm", "cm", "m", "s", "MB"})


class Said(NamedTuple):
    """Sentences as the page says them.

    Attributes:
        by_language: by the code of the language and the English sentence.
        used: keys of the catalogues that were used.
    """

    by_language: Mapping[str, Mapping[str, str]]
    used: Set[str]


def said(sentences: Iterable[str], names: Iterable[str]) -> Said:
    """Return sentences of the server, and names that it gives runs, as the page says them."""
    texts = {"sentences": list(dict.fromkeys(sentences)), "names": list(dict.fromkeys(names))}
    command = [
        *(str(Path(sys.executable).with_name("node")), "--import", "./tests/page/browser.js"),
        _SCRIPT,
    ]
    process = subprocess.run(
        command,
        cwd=assets.static_dir().parent,
        input=json.dumps(texts),
        capture_output=True,
        text=True,
        check=True,
    )
    answer = json.loads(process.stdout)
    return Said(answer["said"], frozenset(answer["used"]))


def english_left(text: str, names: Sequence[str] = ()) -> set[str]:
    """Return the words in a text in full-width letters that are in English; units are none."""
    for name in names:
        text = text.replace(name, "")
    return set(re.findall("[A-Za-z]+", text)) - _FIGURES


@cache
def keys(language: str, part: str = "sentences") -> Set[str]:
    """Return the keys of the sentences, or of another part, that a catalogue has."""
    catalogue = json.loads((assets.static_dir() / f"messages/{language}.json").read_text("utf-8"))
    return frozenset(catalogue[part])


_PLACE = re.compile(r"\{[^}]*\}")


def without_names(text: str) -> str:
    """Return a key, or a text of Python with fields, without the names of its places."""
    return _PLACE.sub("{}", text)


def texts_in(source: str) -> set[str]:
    """Return the texts of a module that are sentences, as an error of the server is said."""
    return {_said(node) for node in ast.walk(ast.parse(source)) if _is_text(node)}


def refusals_in(source: str) -> set[str]:
    """Return the texts with which a module refuses something, as an error of the server is said."""
    calls = [
        node.exc
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and node.exc.args
    ]
    return {
        _said(call.args[0])
        for call in calls
        # What is stored is damaged: no answer of the server.
        if ast.unparse(call.func) != "ValueError" and _is_text(call.args[0])
    }


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.JoinedStr) or (
        isinstance(node, ast.Constant) and isinstance(node.value, str)
    )


def _said(node: ast.AST) -> str:
    parts = node.values if isinstance(node, ast.JoinedStr) else [node]
    texts = [str(part.value) if isinstance(part, ast.Constant) else "{}" for part in parts]
    return as_sentence(without_names("".join(texts)))
