"""`hexapods bench`: run the benchmarks; figures are ratios of times measured in the same run."""

import json
from collections.abc import Callable

from app.cli import benchmarks
from app.cli.options import AsJson
from app.cli.terminal import progress, show_table

TITLES = {
    "training_over_physics": "time of a training, in times of its physics",
    "physics_substeps_per_second": "substeps of physics a second",
    "physics_over_all_that_is_drawn": "time of physics, in times of that of all that is drawn",
    "training_steps_per_second": "steps of practice a second",
    "lookahead_speedup": "speed of look-ahead on all threads, in times of that on one",
    "planning_overhead": "share of a two-step decision that is no physics",
    "two_step_decision_s": "time of a two-step decision, s",
    "threads": "threads",
    "two_step_decision_over_motion": "time of a two-step decision, in times of its motion",
    "picture_encoding_share": "time to encode the picture of three robots, in times of its own",
    "picture_bytes_per_second": "size of the picture of three robots, bytes a second",
}
"""Titles of the figures, by their names in JSON."""
LIMITS = {
    "training_over_physics": "at most 1.10",
    "physics_over_all_that_is_drawn": "at most 1.0",
    "lookahead_speedup": "at least 1.7 on two idle cores",
    "two_step_decision_over_motion": "at most 1.0 on two idle cores",
    "planning_overhead": "at most 0.10",
    "picture_encoding_share": "at most 0.05",
    "picture_bytes_per_second": "at most 9,000",
}


def bench(*, as_json: AsJson = False) -> int:
    """Run the benchmarks, in about a minute; figures are ratios of times of the same run."""
    steps: tuple[Callable[[], dict[str, float]], ...] = (
        benchmarks.training,
        benchmarks.look_ahead,
        benchmarks.racing,
        benchmarks.picture,
    )
    figures: dict[str, float] = {}
    with progress() as bar:
        task = bar.add_task("measuring", total=len(steps))
        for measure in steps:
            figures |= measure()
            bar.advance(task)
    if as_json:
        print(json.dumps(figures))
    else:
        rows = [
            (TITLES[name], _significant(value), LIMITS.get(name, ""))
            for name, value in figures.items()
        ]
        show_table("On this machine, now", ("figure", "measured", "meant to be"), rows, text=(0, 2))
    return 0


def _significant(value: float) -> str:
    """Format a number with four significant digits, never as a power of ten."""
    return f"{value:,.0f}" if value >= 1000 else f"{value:.4g}"
