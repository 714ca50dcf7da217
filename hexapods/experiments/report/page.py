"""The report as one HTML file that opens without a server.

It has the dashboard's own modules and styles (`offline_page`), and blocks of data: `summary`;
`options`, the titles and colours; `report`, its title and the command that repeats the experiment;
`comparisons`, of pairs of settings.
"""

import html
from collections.abc import Mapping
from typing import Any

from hexapods.experiments.presets import PRESETS
from hexapods.experiments.report.command import command
from hexapods.experiments.report.compared_pairs import compared_pairs
from hexapods.experiments.report.page_options import page_options
from hexapods.offline_page import data_block, digest, import_map, styles

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
        data_block(name, data)
        for name, data in (
            ("options", page_options(summary)),
            ("report", report),
            ("summary", summary),
            ("comparisons", {"pairs": compared_pairs(summary)}),
        )
    )
    nonce = digest(modules + blocks)
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
    """Return the page's Content-Security-Policy: its own scripts, style and modules, no network."""
    return (
        "default-src 'none'; connect-src 'none'; base-uri 'none'; form-action 'none'; "
        f"script-src 'nonce-{nonce}'; style-src 'sha256-{digest(style)}'; img-src data: blob:"
    )
