"""The caption of a figure: all that its reader needs to know of it, in plain text."""

from collections.abc import Callable, Mapping

from hexapods.domain.text import counted
from hexapods.experiments.figures.content import FigureContent
from hexapods.experiments.labels import OBSERVATION_LABELS, gait_name, robot_name, world_name
from hexapods.experiments.statistics import MIN_SEEDS, RESAMPLES

_METHOD = "Agarwal et al. 2021"
_UNITS: Mapping[str, str] = {
    "m": "",
    "h": " in half sides of the foot grid",
    "greedy": " as a share of the interquartile mean of greedy’s under the same conditions",
}
_SIMULATORS: Mapping[str, str] = {"kinematic": "ideal simulator without slip"}


def caption_of(content: FigureContent) -> str:
    """Return the caption."""
    sentences = [_subject(content), *_signs(content)]
    if content.comparison is not None:
        sentences.append(str(content.comparison))
    failed = sum(row.entry["failed"] for row in content.rows)  # whole numbers
    if failed:
        sentences.append(f"Left out: {counted(failed, 'trial')} without a distance.")
    sentences.append(_origin(content))
    return " ".join(sentences).replace("\u00a0", " ") + "\n"


def _subject(content: FigureContent) -> str:
    config = content.config
    when = "at time-out" if config.distance == "finished" else "in 50 steps"
    what = {
        "seeds": f"Distance {when}{_UNITS[config.unit]}",
        "comparison": f"Distance {when}{_UNITS[config.unit]}, and its difference",
        "profile": f"Performance profiles of the distance {when}{_UNITS[config.unit]}",
    }[config.kind]
    common = ", ".join(_common(content))
    return f"{what}{f' ({common})' if common else ''}."


def _common(content: FigureContent) -> list[str]:
    """Return the conditions that all settings have in common."""
    words: Mapping[str, Callable[[str], str]] = {
        "gait": gait_name,
        "observation": lambda name: OBSERVATION_LABELS.get(name, name),
        "robot": robot_name,
        "world": world_name,
    }
    texts = []
    for name, label in words.items():
        values = {row.entry.get(name) for row in content.rows}
        if len(values) == 1 and values != {None}:
            texts.append(label(str(values.pop())))
    return texts


def _signs(content: FigureContent) -> list[str]:
    random = [len(row.group.points) for row in content.rows if not row.group.is_deterministic]
    seeds = (
        ""
        if not random
        else f"{counted(random[0], 'seed')} each"
        if len(set(random)) == 1
        else f"{min(random):,} to {counted(max(random), 'seed')} each"
    )
    if content.config.kind == "profile":
        band = (
            "bands: pointwise 95 % Wilson intervals" if max(random, default=0) >= MIN_SEEDS else ""
        )
        return [
            "Lines: share of seeds that come at least as far as τ; "
            + "; ".join(filter(None, [band, seeds]))
            + f" ({_METHOD})."
        ]
    signs = [f"Dots: seeds, {seeds}."] if seeds else []
    if max(random, default=0) >= MIN_SEEDS:
        signs.append(
            "Vertical tick: interquartile mean; bar: its 95 % percentile bootstrap interval, "
            f"{RESAMPLES:,} resamples ({_METHOD})."
        )
    if len(random) < len(content.rows):
        signs.append("Diamond: an agent that walks the same with every seed.")
    if content.best_known is not None:
        signs.append("Dashed: best known distance.")
    return signs


def _origin(content: FigureContent) -> str:
    versions = content.summary["versions"]
    simulator = _SIMULATORS.get(
        content.summary["config"]["simulator"], f"MuJoCo {versions.get('mujoco', '')}".strip()
    )
    product = f"racing-hexapods {versions.get('racing-hexapods', '')}".strip()
    return f"Simulator: {simulator}; {product}, seeds from {content.summary['config']['seed']}."
