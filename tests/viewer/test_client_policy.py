"""The Content-Security-Policy allows exactly the page's scripts, the packed one included."""

import re
from pathlib import Path

import pytest
import viser
import zstandard

from app.viewer.client_page import ViewerPage, patch_script
from app.viewer.client_policy import content_policy

CLIENT = (Path(viser.__file__).parent / "client/build/index.html").read_text("utf-8")
DIGITS = "!#$%()*+,-./0123456789:;=?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_abcdefghijklmnopqrstuvwxyz{|}~"


def in_base_88(data: bytes) -> str:
    text = ""
    for start in range(0, len(data), 4):
        chunk = data[start : start + 4]
        value = int.from_bytes(chunk, "big")
        places = range(len(chunk), -1, -1)
        text += "".join(DIGITS[value // 88**place % 88] for place in places)
    return text


def page(code: str, style: str = "", size: int | None = None) -> str:
    """Return a page in viser's format."""
    packed = in_base_88(zstandard.compress((style + code).encode()))
    sizes = len(style.encode()), len(code.encode()) if size is None else size
    attributes = f'data-p="{packed}" data-ss="{sizes[0]}" data-cs="{sizes[1]}"'
    return f"<head><script>skin()</script><script {attributes}>load()</script></head>"


def hashes(policy: str) -> list[str]:
    return re.findall(r"'sha256-([\w+/=]+)'", policy)


@pytest.mark.parametrize("tail", ["", "1", "12", "123", "1234"])
def test_policy_has_a_hash_for_each_script_and_the_packed_one(tail: str) -> None:
    policies = [content_policy(page(code)) for code in ("app()" + tail, "app() " + tail)]

    one, other = map(hashes, policies)

    assert one[:2] == other[:2]
    assert len({*one, *other}) == 4


def test_packed_style_is_not_part_of_the_hash() -> None:
    assert content_policy(page("α()", "b { --β: 1 }")) == content_policy(page("α()"))


def test_installed_client_has_three_scripts_and_all_are_hashed() -> None:
    headers = ViewerPage().response({}).headers
    policy = headers["content-security-policy"]

    assert len(hashes(policy)) == 3
    script_source = policy.partition("script-src")[2].partition(";")[0]
    for word in ("'unsafe-inline'", "'unsafe-eval'", "'self'", "http"):
        assert word not in script_source
    not_changed = ViewerPage().response({"if-none-match": headers["etag"]})
    assert not_changed.status_code == 304
    assert not_changed.headers["content-security-policy"] == policy


@pytest.mark.parametrize(
    ("html", "what"),
    [
        ("<script>all of it</script>", "of 1 scripts 0 hold the client"),
        (page("app()") + page("app()"), "of 4 scripts 2 hold"),
        (page("app()", size=4), "does not unpack|unpacks to"),
        (page("app()", size=6), "unpacks to 5 bytes, not 6"),
        (page("app()", size=10**12), "would unpack to"),
        (page("app()").replace('data-p="', 'data-p="€'), "does not unpack"),
        (page("app()").replace('data-p="', 'data-p="\\x00'), "does not unpack"),
        (page("app()").replace('data-p="', 'data-p="0'), "does not unpack"),
        (page("app()").replace(" data-cs", " data-x data-cs"), "0 hold the client"),
    ],
)
def test_unsupported_client_raises(html: str, what: str) -> None:
    with pytest.raises(RuntimeError, match=what):
        content_policy(html)


def test_base_88_digits_are_those_of_visers_loader() -> None:
    digits = re.search(r'const A="((?:[^"\\]|\\.)+)"', CLIENT)
    assert digits is not None
    assert digits[1].replace("\\\\", "\\") == DIGITS
    assert "</script" not in patch_script()
