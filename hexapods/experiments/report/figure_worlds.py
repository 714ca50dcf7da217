"""The figures of a league and a recovery: learning curves in each world, with their references."""

from collections.abc import Mapping, Sequence
from typing import Any

from hexapods.agents.appearance import title_of
from hexapods.domain.text import metres
from hexapods.experiments.labels import world_name
from hexapods.experiments.report.drawing import (
    Picture,
    agent_colours,
    draw_best_known,
    figure,
    style_axes,
)
from hexapods.experiments.report.tables import agent_name, place_name, place_of
from hexapods.extras import needs

with needs("experiments", "the report of an experiment"):
    from matplotlib.axes import Axes

PANEL_IN = (3.4, 2.8)
Entry = Mapping[str, Any]


def panels(summary: Mapping[str, Any]) -> list[tuple[str, list[Picture]]]:
    """Draw one picture for each world and gait, grouped by world."""
    groups: dict[str, list[Picture]] = {}
    places = dict.fromkeys(place_of(one) for one in summary["worlds"])
    for number, place in enumerate(places, start=1):
        entries = [one for one in summary["worlds"] if place_of(one) == place]
        name = f"{summary['experiment']}-{number}"
        groups.setdefault(place[0], []).append(_panel(entries, place, name, summary))
    return [(world_name(world), pictures) for world, pictures in groups.items()]


def colours(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return title and colour of each learner, for the key."""
    learners = dict.fromkeys(one["agent"] for one in summary.get("worlds", ()) if one["curve"])
    colour_by_agent = agent_colours(list(learners))
    return [(title_of(agent), colour_by_agent[agent]) for agent in learners]


def _panel(
    entries: Sequence[Entry], place: tuple[str, ...], name: str, summary: Mapping[str, Any]
) -> Picture:
    one = figure(*PANEL_IN)
    ax = one.subplots()
    _draw(
        ax, entries, "after it happened" if summary["experiment"] == "recovery" else "of practice"
    )
    title = place_name(place, summary)
    ax.set_title(title.removeprefix(f"{world_name(place[0])}, "), pad=12)
    return Picture(name, title, _alt(entries, title), one)


def _draw(ax: Axes, entries: Sequence[Entry], what: str) -> None:
    shade = agent_colours([one["agent"] for one in entries])
    learners = [one for one in entries if one["curve"]]
    last = max((one["curve"]["steps"][-1] for one in learners), default=1)
    for one in learners:
        curve, colour = one["curve"], shade[one["agent"]]
        if curve["low_m"][0] is not None:
            ax.fill_between(
                curve["steps"], curve["low_m"], curve["high_m"], color=colour, alpha=0.25, lw=0
            )
        ax.plot(curve["steps"], curve["iqm_m"], color=colour, lw=2, marker="o", ms=3.5)
    known = entries[0]
    draw_best_known(ax, last, known["best_known_m"])
    for field, dashes in (("greedy_m", (4, 2)), ("greedy_nominal_m", (1, 2))):
        if known[field] is not None:
            ax.plot([0, last], [known[field]] * 2, color=shade["greedy"], lw=2, ls=(0, dashes))
    ax.set_xlim(0, last * 1.03)
    ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]))
    ax.set_xlabel(f"steps {what}")
    ax.set_ylabel("distance [m]")
    style_axes(ax, "y")


def _alt(entries: Sequence[Entry], title: str) -> str:
    walks = "; ".join(f"{agent_name(one)} {metres(one['distance']['iqm'])}" for one in entries)
    best_m = entries[0]["best_known_m"]
    known = "" if best_m is None else f"; best known {metres(best_m)}"
    return f"{title}: in the end {walks}{known}."
