"""Parts of HTML files that open without a server: modules and styles of the page, and data."""

import base64
import json
import math
import re

import pytest

from hexapods import assets
from hexapods.offline_page import data_block, digest, import_map, styles

PLAYER = "js/offline/player.js"
REPORT = "features/experiments/offline-report.js"
ADDRESS = "data:text/javascript;base64,"
_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_QUOTED = re.compile(r'"[^"\n]*"')
_IMPORTED = re.compile(r'(?:\bfrom\s*|\bimport\s*\(?)"([\w@./-]+)"')


def modules_of(entry: str) -> dict[str, str]:
    """Return the source of each module of an import map, by its name."""
    imports: dict[str, str] = json.loads(import_map(entry))["imports"]
    assert all(address.startswith(ADDRESS) for address in imports.values())
    return {
        name: base64.b64decode(address.removeprefix(ADDRESS)).decode()
        for name, address in imports.items()
    }


def test_the_player_and_its_imports_are_those_of_the_page() -> None:
    modules = modules_of(PLAYER)
    own = {path.name for path in (assets.static_dir() / "js/offline").iterdir()}

    assert set(modules) == {f"js/offline/{name}" for name in own} | {
        "js/replay-frames.js",
    }
    for name, text in modules.items():
        path = assets.static_dir() / name
        source = assets.as_sent(path, path.read_bytes()).decode()
        # But for the names that they import, which the next test compares.
        assert _QUOTED.sub("", text) == _QUOTED.sub("", source)


@pytest.mark.parametrize("entry", [PLAYER, REPORT])
def test_every_module_that_is_imported_is_in_the_map(entry: str) -> None:
    modules = modules_of(entry)
    code = [_COMMENT.sub("", text) for text in modules.values()]
    imported = {name for text in code for name in _IMPORTED.findall(text)}

    assert imported == set(modules) - {entry}


def test_packages_are_found_by_the_import_map_of_the_page() -> None:
    modules = modules_of(REPORT)
    packages = [name for name in modules if name.startswith("vendor/")]

    assert packages
    assert all("static/" not in name and not name.startswith((".", "/")) for name in modules)


def test_styles_follow_each_other_without_comments() -> None:
    names = ("style/offline.css", "style/page.css")
    texts = [(assets.static_dir() / name).read_text("utf-8") for name in names]
    rules = [re.sub(r"/\*.*?\*/\s*", "", text, flags=re.DOTALL) for text in texts]

    assert rules != texts
    assert styles(*names) == "\n".join(rules)


def test_data_cannot_end_its_block() -> None:
    data = {"name": '</script><script>alert("1")</script>', "numbers": [1, 2.5, None]}
    block = data_block("summary", data)

    match = re.fullmatch(r'<script type="text/plain" id="summary">([^<]*)</script>', block)
    assert match is not None
    assert json.loads(match[1]) == data


def test_bytes_are_in_base64() -> None:
    assert data_block("scene", b"\x00<\xff") == (
        f'<script type="text/plain" id="scene">{base64.b64encode(bytes([0, 60, 255])).decode()}'
        "</script>"
    )


@pytest.mark.parametrize("number", [math.nan, math.inf])
def test_numbers_that_json_lacks_are_refused(number: float) -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        data_block("summary", {"distance_m": number})


def test_the_digest_is_that_of_a_content_security_policy() -> None:
    # SHA-256 of "abc", FIPS 180-2, appendix B.1.
    digits = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"

    assert base64.b64decode(digest("abc")).hex() == digits
