"""The figures of a report: as panels for a page, and as sheets for files."""

from collections.abc import Mapping
from typing import Any

from app.experiments.claims.cases import cases
from app.experiments.report import figure_curves, figure_sweep, figure_table1
from app.experiments.report.drawing import Picture, look


def panels(summary: Mapping[str, Any]) -> list[tuple[str, list[Picture]]]:
    """Small pictures in groups, each group under its own heading, fit for a page that reflows."""
    places = cases(summary)
    with look():
        if summary["experiment"] == "table1":
            return [("", figure_table1.panels(places))]
        if summary["experiment"] == "figure4":
            top = figure_curves.highest(places)
            return [
                (case.label, figure_curves.panels(case, top, f"figure4-{number + 1}"))
                for number, case in enumerate(places)
            ]
        pictures = [figure_sweep.panel(c, f"sweep-{n + 1}") for n, c in enumerate(places)]
        return [("", pictures)]


def sheets(summary: Mapping[str, Any]) -> list[Picture]:
    """Whole figures, for slides and handouts."""
    places = cases(summary)
    with look():
        if summary["experiment"] == "table1":
            return [figure_table1.sheet(places)]
        if summary["experiment"] == "figure4":
            return [figure_curves.sheet(places)]
    return [picture for _, group in panels(summary) for picture in group]
