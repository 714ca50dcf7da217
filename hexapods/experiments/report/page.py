"""The report as one HTML file that opens without a server.

It has the dashboard's own modules and styles, and blocks of data: `summary`; `options`, the titles
and colours; `report`, its title and the command that repeats the experiment. By its
Content-Security-Policy it can load nothing but its own modules.
"""

import base64
import hashlib
import html
import json
from collections.abc import Mapping
from typing import Any

from hexapods.experiments.presets import PRESETS
from hexapods.experiments.report.command import command
from hexapods.experiments.report.page_modules import import_map, styles
from hexapods.experiments.report.page_options import page_options

_ENTRY = "features/experiments/offline-report.js"
_STYLES = (
    "style/page.css",
    "style/race.css",
    "style/workspace.css",
    "features/experiments/experiments.css",
    "features/experiments/offline-report.css",
)


def page(summary: Mapping[str, Any]) -> str:
    """Return the page; the same summary gives the same text."""
    title = PRESETS[summary["experiment"]].heading
    style, modules, start = styles(*_STYLES), import_map(_ENTRY), f'import "{_ENTRY}";'
    report = {"title": title, "command": command(summary["config"])}
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{_policy(style, modules, start)}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<link rel="icon" href="data:,">
<title>{html.escape(title)}</title>
<style>{style}</style>
<script type="importmap">{modules}</script>
{_block("options", page_options(summary))}
{_block("report", report)}
{_block("summary", summary)}
<script type="module">{start}</script>
</head>
<body>
<noscript><p>This report needs JavaScript; summary.json beside it has its numbers.</p></noscript>
</body>
</html>
"""


def _policy(style: str, *scripts: str) -> str:
    """Return the page's Content-Security-Policy: its own scripts, style and modules, no network."""
    hashes = " ".join(map(_hash, scripts))
    return (
        "default-src 'none'; connect-src 'none'; base-uri 'none'; form-action 'none'; "
        f"script-src {hashes} data:; style-src {_hash(style)}; img-src data: blob:"
    )


def _hash(text: str) -> str:
    digest = hashlib.sha256(text.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"


def _block(name: str, data: Mapping[str, Any]) -> str:
    """Return an element that holds data; its type is none that browsers run."""
    # "<" could end the block.
    text = json.dumps(data, allow_nan=False).replace("<", "\\u003c")
    return f'<script type="text/plain" id="{name}">{text}</script>'
