"""The check of the site's links finds what leads nowhere, and passes what leads somewhere."""

from pathlib import Path

import pytest

from tests.docs.programs import DOCS
from tests.docs.site_links import broken_links, external_links, main

PAGE = '<html><body><h2 id="here">Here</h2>{}</body></html>'


def site(folder: Path, *links: str) -> Path:
    """Write a site with two pages, a file and a picture; the links are those of `a.html`."""
    (folder / "sub").mkdir()
    anchors = "".join(f'<a href="{link}">x</a>' for link in links)
    (folder / "a.html").write_text(PAGE.format(anchors), "utf-8")
    (folder / "sub" / "index.html").write_text(PAGE.format('<img src="../p.png">'), "utf-8")
    (folder / "p.png").write_bytes(b"")
    (folder / "llms.txt").write_text("# Site\n\n- [A](a.html#here): a page", "utf-8")
    return folder


def test_links_that_lead_somewhere_pass(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    links = ("#here", "#", "sub/index.html#here", "sub/", "p.png", "https://example.org/x", "")
    assert main(str(site(tmp_path, *links))) == 0
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("link", "reason"),
    [
        ("b.html", "there is no such file"),
        ("../outside.html", "there is no such file"),
        ("#there", "a.html has no such part"),
        ("sub/index.html#there", "sub/index.html has no such part"),
        ("p.gif", "there is no such file"),
    ],
)
def test_a_link_that_leads_nowhere_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], link: str, reason: str
) -> None:
    assert [*broken_links(site(tmp_path, "#here", link))] == [
        f"a.html links to {link}, and {reason}"
    ]
    assert main(str(tmp_path)) == 1
    assert reason in capsys.readouterr().out


def test_llms_txt_is_checked_and_must_be_there(tmp_path: Path) -> None:
    contents = site(tmp_path) / "llms.txt"
    contents.write_text("- [B](b.html)", "utf-8")
    assert [*broken_links(tmp_path)] == ["llms.txt links to b.html, and there is no such file"]
    contents.unlink()
    with pytest.raises(ValueError, match=r"no llms\.txt"):
        [*broken_links(tmp_path)]


def test_links_to_other_sites_are_counted_by_host(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = site(tmp_path, "https://a.org/1", "https://a.org/2", "https://b.org/", "#here")
    assert external_links(folder) == {"a.org": 2, "b.org": 1}
    assert main(str(folder), "--external") == 0
    assert "    3 addresses of other sites" in capsys.readouterr().out


def test_no_page_has_the_name_of_one_that_sphinx_writes_itself_over_it() -> None:
    assert {path.stem for path in DOCS.glob("*.md")} & {
        "genindex",
        "py-modindex",
        "search",
    } == set()
