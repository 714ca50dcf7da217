"""The figures of a report: as panels for the page, and as sheets for files."""

from collections.abc import Mapping
from typing import Any

from hexapods.experiments.claims.cases import cases_of
from hexapods.experiments.presets import PRESETS
from hexapods.experiments.report import (
    figure_curves,
    figure_sweep,
    figure_table1,
    figure_worlds,
)
from hexapods.experiments.report.drawing import Picture, figure_style


def panels(summary: Mapping[str, Any]) -> list[tuple[str, list[Picture]]]:
    """Draw small pictures for the page, in groups of (heading, pictures)."""
    cases = cases_of(summary)
    with figure_style():
        if summary["experiment"] == "table1":
            return [("", figure_table1.panels(cases))]
        if summary["experiment"] == "figure4":
            top = figure_curves.highest(cases)
            return [
                (case.label, figure_curves.panels(case, top, f"figure4-{number + 1}"))
                for number, case in enumerate(cases)
            ]
        if PRESETS[summary["experiment"]].has_worlds:
            return figure_worlds.panels(summary)
        pictures = [figure_sweep.panel(c, f"sweep-{n + 1}") for n, c in enumerate(cases)]
        return [("", pictures)]


def sheets(summary: Mapping[str, Any]) -> list[Picture]:
    """Draw whole figures for files, such as for slides and handouts."""
    cases = cases_of(summary)
    with figure_style():
        if summary["experiment"] == "table1":
            return [figure_table1.sheet(cases)]
        if summary["experiment"] == "figure4":
            return [figure_curves.sheet(cases)]
    return [picture for _, group in panels(summary) for picture in group]
