"""`hx.view`: a race as a page that plays it without a server, and as a picture of its end."""

import html
import io
import os
import re
from email.message import Message
from pathlib import Path

import pytest
from PIL import Image

import hexapods as hx


def test_a_race_is_a_page(tmp_path: Path) -> None:
    race = hx.race(["greedy", "wave"], steps=3, simulator="kinematic")
    view = hx.view(race, title="A <race>")
    page = view.save(tmp_path / "race.html").read_text("utf-8")
    assert "<title>A &lt;race&gt;</title>" in page
    assert '"kind": "race"' in page
    assert "default-src 'none'" in page
    [srcdoc] = re.findall('srcdoc="([^"]*)"', view._repr_html_())
    assert html.unescape(srcdoc) == page
    assert repr(view).startswith("<View of A <race>: ")


def test_without_scripts_a_notebook_shows_a_picture_and_how_to_play_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    view = hx.view(hx.race(["greedy", "wave"], steps=3, simulator="kinematic"))
    assert Image.open(io.BytesIO(view._repr_png_())).size == (800, 450)
    assert view.description.startswith("At the time-out: Greedy 0.0")
    assert 'hx.view(…).save("race.html")' in view._repr_html_()

    view.save(tmp_path / "my race.html")
    # What sanitisers leave: neither frames nor styles.
    left = re.sub("<iframe.*?</iframe>", "", view._repr_html_())
    assert '<img src="data:image/png;base64,' in left
    assert f'alt="{view.description}"' in left
    assert '<a href="my%20race.html">my race.html</a>' in left
    assert os.path.lexists("my race.html")


def test_the_sentence_links_to_the_documentation_that_the_package_states(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    metadata = Message()
    monkeypatch.setattr("importlib.metadata.metadata", lambda _: metadata)
    view = hx.View("A race", "<p>", b"", "")
    assert "<a " not in view._repr_html_()
    metadata["Project-URL"] = "Issues, https://code.test/issues"
    metadata["Project-URL"] = "Documentation, https://code.test/docs?a&b"
    assert '<a href="https://code.test/docs?a&amp;b">Documentation</a>' in view._repr_html_()


@pytest.mark.test
def test_a_notebook_has_the_page_the_picture_and_a_line_of_text() -> None:
    from IPython.core.formatters import DisplayFormatter  # half a second

    view = hx.View("A race", "<p>", b"\x89PNG", "")
    bundle, _ = DisplayFormatter().format(view)
    assert set(bundle) == {"text/html", "image/png", "text/plain"}
    assert bundle["image/png"] == view.picture
    assert bundle["text/plain"].startswith("<View of A race: ")


@pytest.mark.test
def test_a_training_walks_alone() -> None:
    training = hx.train(steps=20, simulator="kinematic", seed=3)
    assert hx.view(training).title == "Q-learning: 50 steps"


def test_a_browser_opens_a_file_that_the_next_replaces(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path))
    monkeypatch.setattr("webbrowser.open", opened.append)
    paths = [hx.View(title, f"<p>{title}", b"", "").open() for title in ("one", "two")]
    assert paths[0] == paths[1]
    assert opened == [path.as_uri() for path in paths]
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == paths[:1]
    assert paths[0].read_text("utf-8") == "<p>two"


def test_a_title_is_a_text() -> None:
    with pytest.raises(hx.InvalidInput, match="title is a text, not 3"):
        hx.view(hx.race(["wave"], steps=2, simulator="kinematic"), title=3)  # type: ignore[arg-type]


def test_no_clock_is_refused() -> None:
    with pytest.raises(hx.InvalidInput, match="paper, wall or free, or several of them"):
        hx.view(hx.race(["wave"], steps=2, simulator="kinematic"), clock=[])


def test_an_unknown_clock_is_refused() -> None:
    with pytest.raises(hx.UnknownName, match="paper, wall, free"):
        hx.view(hx.race(["wave"], steps=2, simulator="kinematic"), clock="sun")  # type: ignore[arg-type]
