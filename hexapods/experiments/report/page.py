"""The report as one HTML file that opens without a server.

It has the dashboard's own modules and styles, and blocks of data: `summary`; `options`, the titles
and colours; `report`, its title and the command that repeats the experiment. By its
Content-Security-Policy it can load nothing but its own modules: modules are `data:` addresses, of
which only those are run that an element with the page's nonce imports.
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
    style, modules = styles(*_STYLES), import_map(_ENTRY)
    report = {"title": title, "command": command(summary["config"])}
    blocks = "\n".join(
        _block(name, data)
        for name, data in (
            ("options", page_options(summary)),
            ("report", report),
            ("summary", summary),
        )
    )
    nonce = _digest(modules + blocks)
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{_policy(style, nonce)}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<link rel="icon" href="data:,">
<title>{html.escape(title)}</title>
<style>{style}</style>
<script type="importmap" nonce="{nonce}">{modules}</script>
{blocks}
<script type="module" nonce="{nonce}">import "{_ENTRY}";</script>
</head>
<body>
<noscript><p>This report needs JavaScript; summary.json beside it has its numbers.</p></noscript>
</body>
</html>
"""


def _policy(style: str, nonce: str) -> str:
    """Return the page's Content-Security-Policy: its own scripts, style and modules, no network.

    The nonce is a digest of all that the page has, so that the same summary gives the same page,
    and no data in it can name the nonce.
    """
    return (
        "default-src 'none'; connect-src 'none'; base-uri 'none'; form-action 'none'; "
        f"script-src 'nonce-{nonce}'; style-src 'sha256-{_digest(style)}'; img-src data: blob:"
    )


def _digest(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _block(name: str, data: Mapping[str, Any]) -> str:
    """Return an element that holds data; its type is none that browsers run."""
    # "<" could end the block.
    text = json.dumps(data, allow_nan=False).replace("<", "\\u003c")
    return f'<script type="text/plain" id="{name}">{text}</script>'
