"""The sheet of a lesson for its teacher: a page to print, with what each card asks and reveals."""

from html import escape

from app.features.classroom.lesson import Card, Lesson, html_of
from app.features.classroom.markdown import as_html
from app.features.classroom.questions import Ask
from app.features.classroom.teach import Teach
from hexapods.agents.appearance import title_of
from hexapods.agents.registry import registered

_RUNS = {
    "training": "Their robots practise.",
    "race": "Their robots practise, then race.",
    "what-if": "Each tries settings on thirty robots.",
}
_RIVALS = {
    "reward": "that learned from the reward",
    "simulated": "that a simulated person taught",
}
_STYLE = """
@page { size: A4; margin: 9mm 11mm; }
:root { font: 9.5pt/1.28 system-ui, "DejaVu Sans", sans-serif; color-scheme: light; }
:root { color: #111; background: #fff; }
body { max-width: 190mm; margin: 0 auto; padding: 8mm 0; }
@media print { body { max-width: none; padding: 0; } .print { display: none; } }
h1 { margin: 0; font-size: 17pt; line-height: 1.1; letter-spacing: -.02em; }
h2 { margin: 0; font-size: 10pt; }
p { margin: 0; }
p + p, ul + p, p + ul { margin-top: .25em; }
ul { margin: 0; padding-left: 1.2em; }
.about { color: #444; margin: 1mm 0 2mm; }
.aims { margin-bottom: 2mm; }
.cards { columns: 2; column-gap: 7mm; border-top: .4mm solid #111; padding-top: 2.5mm; }
.card { break-inside: avoid; margin-bottom: 2.6mm; padding-bottom: 1.8mm; }
.card { border-bottom: .2mm solid #bbb; }
.asks { font-weight: 600; }
.asks * { font-weight: 600; }
.does { color: #444; }
.reveals { padding-left: 2mm; border-left: .8mm solid #157a35; margin-top: .35em; }
.print { float: right; font: inherit; }
"""


def sheet_of(lesson: Lesson) -> str:
    """Return the sheet of a lesson as an HTML page that prints on one sheet of A4."""
    about = [f"{len(lesson.cards)} cards"]
    about += [] if lesson.minutes is None else [f"{lesson.minutes} minutes"]
    about += [] if lesson.ages is None else [lesson.ages]
    aims = "".join(f"<li>{escape(aim)}</li>" for aim in lesson.aims)
    cards = "".join(_card(number, card) for number, card in enumerate(lesson.cards, 1))
    if lesson.before is not None:
        after = lesson.after or lesson.before
        cards = _knowledge("Before the first card", lesson.before, None) + cards
        cards += _knowledge("After the last card", after, after.right)
    return (
        f'<!doctype html>\n<html lang="{escape(lesson.language)}">\n<head>\n'
        '<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(lesson.title)}: sheet for the teacher</title>\n<style>{_STYLE}</style>\n"
        f"</head>\n<body>\n<header><h1>{escape(lesson.title)}</h1>\n"
        f'<p class="about">{escape(" · ".join(about))} · Sheet for the teacher, with the answers'
        f'</p></header>\n<ul class="aims">{aims}</ul>\n<main class="cards">{cards}</main>\n'
        "</body>\n</html>\n"
    )


def _card(number: int, card: Card) -> str:
    texts = html_of(card)
    title = "" if card.title is None else f" {escape(card.title)}"
    answer = card.revealed.answer
    reveal = texts.reveal
    if answer is not None:
        reveal = _right(answer) + reveal
    opened = ", ".join(card.may)
    does = [] if card.go is None else [_RUNS[card.go]]
    does += [] if card.teach is None else [_taught(card.teach)]
    does += [f"They may change: {opened}."] if opened else []
    return (
        f'<section class="card"><h2>{number}.{title}</h2>{texts.text}'
        + ("" if card.ask is None else _asked(card.ask))
        + (f'<p class="does">{escape(" ".join(does))}</p>' if does else "")
        + (f'<div class="reveals">{reveal}</div>' if reveal else "")
        + "</section>"
    )


def _taught(teach: Teach) -> str:
    """Return in sentences what a class does on a card on which it teaches."""
    return (
        f"Together they teach a robot by + and − for {teach.seconds:g} s ({teach.steps:,} steps); "
        f"you start it. At the reveal it races one {_RIVALS[teach.rival]}."
    )


def _knowledge(title: str, ask: Ask, right: float | str | None) -> str:
    reveal = "" if right is None else f'<div class="reveals">{_right(right)}</div>'
    return f'<section class="card"><h2>{escape(title)}</h2>{_asked(ask)}{reveal}</section>'


def _right(answer: float | str) -> str:
    return f"<p>Right: <b>{escape(_named(answer))}</b></p>"


def _asked(ask: Ask) -> str:
    choices = " · ".join(escape(_named(choice)) for choice in ask.choices)
    words = f"<p>{choices}</p>" if choices else ""
    return f'<div class="asks">{as_html(ask.text)}</div>{words}'


def _named(answer: float | str) -> str:
    """Return an answer as a person reads it; the name of an agent stands for its win."""
    if isinstance(answer, str):
        return title_of(answer) if answer in registered() else answer
    return f"{answer:g}"
