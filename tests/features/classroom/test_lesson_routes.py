"""Lessons over REST: stored, listed and exported, and what is refused with which sentence."""

import json
import re
from collections.abc import Iterator, Set
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest

from app.features.classroom import lessons
from app.features.classroom.lesson import MAX_CARDS, html_of, plain, read_lesson
from app.features.classroom.lesson_file import MAX_BYTES, read_file, write_file
from app.features.classroom.lesson_sheet import sheet_of
from app.features.classroom.lessons import built_in, languages
from app.features.classroom.tables import LESSONS
from hexapods import assets
from hexapods.agents.registry import BUILT_IN
from tests.api.calls import Api, refused

YAML = {"Content-Type": "application/yaml"}
LESSON: dict[str, Any] = {
    "title": "No: 1, a “lesson”",
    "language": "de-AT",
    "aims": ["yes", "0.10"],
    "cards": [
        {"text": "First line\n\n- **one**\n- two & <3"},
        {
            "title": "Guess",
            "text": "",
            "state": {"depth": "try", "tab": "train", "form": {"steps": 60, "alpha": "0.3"}},
            "show": ["board", "train"],
            "may": {"alpha": {"minimum": 0.1}, "gait": {"choices": ["tripod"]}, "gamma": {}},
            "ask": {"kind": "choice", "text": "Which?", "choices": ["no", "on"]},
            "go": "training",
            "reveal": {"text": "That.", "answer": "on"},
        },
    ],
}
BOMB = "title: &a [x, x]\ncards: [*a, *a]\n"


def test_a_lesson_is_the_same_as_json_and_as_a_file(api: Api) -> None:
    created = api.call("POST", "/lessons", json=LESSON)
    assert created.status_code == 201, created.text
    lesson_id = created.json()["id"]
    assert created.headers["location"] == f"/api/v1/lessons/{lesson_id}"
    assert created.json()["link"].endswith(f"/l/{lesson_id}")
    shown = api.get(f"/lessons/{lesson_id}")
    file = api.call("GET", f"/lessons/{lesson_id}?format=yaml")
    assert file.headers["content-type"].startswith("application/yaml")
    accepted = api.call("GET", f"/lessons/{lesson_id}", headers={"Accept": "application/yaml"})
    assert accepted.text == file.text
    again = api.call("POST", "/lessons", content=file.content, headers=YAML)
    assert (again.status_code, again.json()["id"]) == (201, lesson_id)
    lesson = read_lesson(LESSON)
    assert read_file(file.content, "the file") == lesson
    assert (shown["title"], shown["aims"], shown["is_built_in"]) == (
        *(LESSON["title"], LESSON["aims"], False),
    )
    assert shown["cards"][1]["may"]["gamma"] == {"minimum": None, "maximum": None, "choices": None}
    assert "<strong>one</strong>" in shown["html"][0]["text"]
    assert "&lt;3" in shown["html"][0]["text"]
    listed = {entry["id"]: entry for entry in api.get("/lessons")["items"]}
    assert listed[lesson_id]["cards"] == 2
    assert api.client.get(f"/l/{lesson_id}").url.query == f"lesson={lesson_id}".encode()
    assert api.call("DELETE", f"/lessons/{lesson_id}").status_code == 200
    refused(api.call("GET", f"/lessons/{lesson_id}"), 404, "no lesson")


def test_a_lesson_that_was_deleted_comes_back_for_an_hour(
    api: Api, monkeypatch: pytest.MonkeyPatch
) -> None:
    lesson_id = api.call("POST", "/lessons", json=LESSON).json()["id"]
    path = f"/lessons/{lesson_id}"
    before = api.get(path), api.get("/lessons")
    deleted = api.call("DELETE", path).json()
    assert (deleted["deleted"], deleted["kept"]) == ([lesson_id], [])
    assert datetime.fromisoformat(deleted["restorable_until"]) > datetime.now(UTC)
    refused(api.call("GET", path), 404, "no lesson")
    refused(api.call("DELETE", path), 404, "no stored lesson")
    refused(api.call("POST", "/rooms", json={"lesson": lesson_id}), 404, "no lesson")
    assert lesson_id not in [entry["id"] for entry in api.get("/lessons")["items"]]
    for _ in range(2):
        restored = api.call("POST", f"{path}/restore")
        assert (restored.status_code, restored.json()) == (200, before[0])
    assert (api.get(path), api.get("/lessons")) == before

    api.call("DELETE", path)
    assert api.call("POST", "/lessons", json=LESSON).json()["id"] == lesson_id, "stored again"
    assert api.call("POST", f"{path}/restore").json() == before[0]
    api.call("DELETE", path)
    deletions = api.services.store.deletions
    monkeypatch.setattr(deletions, "now", lambda: datetime.now(UTC) + timedelta(hours=2))
    assert deletions.purge() >= 1
    refused(api.call("POST", f"{path}/restore"), 404, "can be restored for 1 h")
    refused(api.call("POST", f"/lessons/{next(iter(built_in()))}/restore"), 404, "no stored lesson")


def test_the_sheet_of_a_card_that_teaches_says_what_the_class_does() -> None:
    card = {"text": "Press.", "teach": {"seconds": 60, "step_s": 1, "rival": "simulated"}}
    sheet = sheet_of(read_lesson({"title": "Teach", "cards": [card]}))
    assert "by + and − for 60 s (60 steps)" in sheet
    assert "races one that a simulated person taught" in sheet


def test_the_most_lessons_are_counted_with_those_that_were_deleted(
    api: Api, monkeypatch: pytest.MonkeyPatch
) -> None:
    api.services.store.deletions.purge_rows(LESSONS, LESSONS.c.id != "")
    stored = [entry for entry in api.get("/lessons")["items"] if not entry["is_built_in"]]
    monkeypatch.setattr(lessons, "MAX_LESSONS", len(stored) + 1)
    first, second = ({**LESSON, "title": title} for title in ("The first", "The second"))
    lesson_id = api.call("POST", "/lessons", json=first).json()["id"]
    refused(api.call("POST", "/lessons", json=second), 429, "delete one")
    api.call("DELETE", f"/lessons/{lesson_id}")
    other_id = api.call("POST", "/lessons", json=second).json()["id"]
    refused(api.call("POST", f"/lessons/{lesson_id}/restore"), 404, "restored for 1 h")
    api.call("DELETE", f"/lessons/{other_id}")


def test_built_in_lessons_can_be_started_and_exported(api: Api) -> None:
    all_built_in = built_in()
    listed = {entry["id"] for entry in api.get("/lessons")["items"] if entry["is_built_in"]}
    assert listed == set(all_built_in)
    assert len(listed) >= 2
    for lesson_id, lesson in all_built_in.items():
        assert read_file(write_file(lesson).encode(), lesson_id) == lesson
        assert lesson.aims
        file = api.call("GET", f"/lessons/{lesson_id}?format=yaml").content
        assert api.call("POST", "/lessons", content=file, headers=YAML).status_code == 201
        refused(api.call("DELETE", f"/lessons/{lesson_id}"), 404, "built in stay")


def texts_of(document: Any) -> Iterator[str]:
    """Yield the texts of a lesson that people read; choices that name agents are none."""
    if isinstance(document, str):
        if re.search(r"[^\W\d]{2}|\d\.\d", document) and document not in BUILT_IN:
            yield document
    elif isinstance(document, list):
        for item in document:
            yield from texts_of(item)
    elif isinstance(document, dict):
        for name, value in document.items():
            if name not in {"language", "state", "show", "may", "go", "teach", "kind"}:
                yield from texts_of(value)


def without_texts(document: Any, texts: Set[str]) -> Any:
    if isinstance(document, dict):
        return {
            name: without_texts(value, texts)
            for name, value in document.items()
            if name != "language"
        }
    if isinstance(document, list):
        return [without_texts(item, texts) for item in document]
    return None if isinstance(document, str) and document in texts else document


def test_built_in_lessons_are_in_all_languages_of_the_page() -> None:
    english = {text for lesson in built_in().values() for text in texts_of(plain(lesson))}
    of_the_page = sorted(path.stem for path in assets.static_dir().glob("messages/*.json"))
    assert languages() == ("en", *of_the_page)
    for language in of_the_page:
        file = Path(lessons.__file__).with_name("built_in") / f"languages/{language}.json"
        catalogue = json.loads(file.read_text("utf-8"))
        assert set(catalogue) == english
        assert all(catalogue.values())
        for lesson_id, lesson in built_in(language).items():
            translated, original = plain(lesson), plain(built_in()[lesson_id])
            assert lesson.language == language
            assert without_texts(translated, set(catalogue.values())) == without_texts(
                original, english
            )


def test_a_built_in_lesson_is_had_in_a_language(api: Api) -> None:
    lesson_id = "legs-and-balance"
    address = f"/lessons/{lesson_id}?language=de"
    lesson = api.get(address)
    listed = {entry["id"]: entry["title"] for entry in api.get("/lessons?language=de")["items"]}

    assert lesson["language"] == "de"
    assert lesson["title"] == listed[lesson_id] == "Beine und Gleichgewicht"
    assert "<em>Stützpolygon</em>" in str(lesson["html"])
    unknown = "language of the built-in lessons 'xx'; choose one of: en, de, fr"
    for path in ("/lessons", f"/lessons/{lesson_id}"):
        refused(api.call("GET", f"{path}?language=xx"), 422, unknown)
    refused(api.call("POST", "/rooms", json={"lesson": lesson_id, "language": "xx"}), 422, unknown)


@pytest.mark.parametrize("form", ["json", "yaml"])
def test_a_lesson_has_no_more_names_and_values_than_its_file(api: Api, form: str) -> None:
    if form == "yaml":
        text = "".join(f"k{number:05d}: 1\n" for number in range(25_000))
        answer = api.call("POST", "/lessons", content=text, headers=YAML)
    else:
        answer = api.call("POST", "/lessons", json={"title": "x", "cards": [{}] * 25_000})
    refused(answer, 422, "more than 10,000 names and values")


def card(**fields: Any) -> dict[str, Any]:
    return {"title": "x", "cards": [{"text": "x", **fields}]}


@pytest.mark.parametrize(
    ("lesson", "words"),
    [
        ([], "a lesson is an object with title and cards"),
        ({"title": "x"}, "cards is missing"),
        ({"title": "x", "cards": []}, "cards"),
        ({"title": 5, "cards": [{"text": "x"}]}, "title: must be a valid string"),
        ({"title": "a\u202eb", "cards": [{"text": "x"}]}, "title must be one line of text"),
        ({"title": "x", "cards": [{"text": "x"}] * (MAX_CARDS + 1)}, "cards"),
        ({**card(), "pages": 1}, "unknown field 'pages'; choose one of: title, language, minutes"),
        (card(txt=1), "cards.0: unknown field 'txt'; choose one of: title, text"),
        (card(text="<script>alert(1)</script>"), "cards.0.text has HTML, '<script>"),
        (card(text="a <img src=x onerror=y> b"), "cards.0.text has HTML"),
        (card(text="![x](http://203.0.113.1/x.png)"), "has a picture"),
        (card(text="[x](ftp://203.0.113.1)"), "links begin with http, https, mailto"),
        (card(reveal={"text": "<b>x</b>"}), "cards.0.reveal has HTML"),
        (card(state={"depht": "try"}), "unknown field 'depht'; choose one of: view, form"),
        (card(state={"depth": "deep"}), "'watch', 'try' or 'study'"),
        (card(show=["bord"]), "'board', 'train'"),
        (card(may={"alhpa": {}}), "unknown setting 'alhpa'; choose one of: gait"),
        (card(may={"alpha": {"maximum": 1.5}}), "setting's own bounds: a number over 0 and at"),
        (card(may={"steps": {"minimum": 0}}), "a whole number from 1 to"),
        (card(may={"gait": {"choices": ["gallop"]}}), "unknown choice 'gallop'"),
        (card(may={"gait": {"maximum": 1}}), "are of numbers alone; give choices"),
        (card(may={"alpha": {"minimum": 0.5, "maximum": 0.2}}), "must be at most maximum, 0.2"),
        (card(may={"pace": {}}), "unknown setting 'pace'"),
        (card(ask={"kind": "essay", "text": ""}), "'choice', 'number', 'point' or 'curve'"),
        (card(ask={"kind": "choice", "text": "", "choices": ["a"]}), "2 to 20 different texts"),
        (card(ask={"kind": "point", "text": "", "choices": ["a", "b"]}), "kind choice alone"),
        (card(ask={"kind": "number", "text": "", "minimum": 2, "maximum": 1}), "less than its"),
        (card(go="training", state={"form": {"gait": "gallop"}}), "cards.0.state.form: "),
        (card(go="training", state={"form": {"wings": 2}}), "unknown field 'wings'"),
        (card(go="training", state={"form": {"alpha": 7}}), "cards.0.state.form: "),
        (card(go="race", state={"form": {"lanes": ["nobody"]}}), "nobody"),
    ],
)
def test_what_is_no_lesson_is_refused(api: Api, lesson: Any, words: str) -> None:
    problem = refused(api.call("POST", "/lessons", json=lesson), 422)
    assert words.lower() in problem["detail"].lower()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (BOMB, "line 2: not valid YAML: *a: aliases are not read"),
        ("title: [\n", "not valid YAML"),
        ("title: !!python/object/apply:os.system [ls]\n", "the tag 'python/object/apply"),
        ("title: x\ntitle: y\n", "line 2: 'title' is given twice"),
        ("title: x\ncards: [{text: !!binary aGk=}]\n", "the tag"),
        ("[" * 40, "nested too deeply"),
        ("", "title and cards"),
        ("title: x\ncards: [{text: 1e999}]\n", "no infinite numbers"),
        ("x" * (MAX_BYTES + 1), "at most 256 kB"),
        ("\x00", "not valid YAML"),
    ],
)
def test_what_is_no_file_of_a_lesson_is_refused(api: Api, text: str, words: str) -> None:
    problem = refused(api.call("POST", "/lessons", content=text.encode(), headers=YAML), 422)
    assert words.lower() in problem["detail"].lower()


def test_a_lesson_that_is_nested_too_deeply_is_refused(api: Api) -> None:
    for nested in ("[" * 900 + "]" * 900, '{"title":' * 900 + "1" + "}" * 900):
        answer = api.call(
            "POST", "/lessons", content=nested, headers={"Content-Type": "application/json"}
        )
        refused(answer, 422)


def test_a_link_that_looks_like_a_script_is_text() -> None:
    lesson = read_lesson(card(text="[x](javascript:alert(1)) and [y](JaVaScRiPt:alert(1))"))
    assert "href" not in html_of(lesson.cards[0]).text


def test_a_card_without_a_lesson_is_refused(api: Api) -> None:
    refused(api.call("POST", "/rooms", json={"lesson": "nothing"}), 404, "no lesson")
    refused(api.call("POST", "/rooms", json={"lesson": {"title": "x"}}), 422, "ards is missing")
    refused(api.client.get("/l/nothing"), 404, "no lesson")
