"""Options of experiments and sweeps: trial grid, machines, results folder."""

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from app.cli.options import integer, read_gait, read_robot, split
from hexapods.domain.gait import NAMED_GAITS, PAPER_GAITS, GaitSpec
from hexapods.domain.observation import OBSERVATIONS, PAPER_OBSERVATIONS
from hexapods.domain.robot import PRESETS, Robot
from hexapods.experiments.cluster import ClusterSpec
from hexapods.runs.config import SIMULATORS

T = TypeVar("T")


def add_trial_options(parser: argparse.ArgumentParser, observations: str, robots: str) -> None:
    """Add the options of a trial grid that `experiment` and `sweep` share.

    Args:
        parser: parser of the command.
        observations: default observations, for the help text.
        robots: default robots, for the help text.
    """
    parser.add_argument("--seeds", type=integer, help="number of seeds per learner (default 30)")
    parser.add_argument(
        "--seed",
        type=integer,
        help="root seed from which all others are spawned (default 0)",
    )
    parser.add_argument(
        "--gait",
        action="append",
        help=f"all (the paper's four, default), one or more of {', '.join(NAMED_GAITS)}, or JSON",
    )
    parser.add_argument(
        "--observation",
        action="append",
        help=f"both (the paper's two), all, or one or more of {', '.join(OBSERVATIONS)} "
        f"(default {observations})",
    )
    parser.add_argument(
        "--robot",
        action="append",
        help=f"one or more of {', '.join(PRESETS)}, a stored one, a TOML file, or JSON "
        f"(default {robots})",
    )
    parser.add_argument(
        "--simulator", help=f"simulator: {' or '.join(SIMULATORS)} (default mujoco)"
    )


def add_machine_options(parser: argparse.ArgumentParser) -> None:
    """Add the options for workers or cluster, results folder and output."""
    parser.add_argument(
        "--workers", type=integer, help="worker processes on this machine (default: one per core)"
    )
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="scheduler of a Dask cluster, tcp://HOST:PORT or tls://…",
    )
    for name, what in (
        ("ca", "CA"),
        ("cert", "client certificate"),
        ("key", "key of the client certificate"),
    ):
        parser.add_argument(f"--tls-{name}", metavar="PEM", help=f"{what}, for a tls:// scheduler")
    parser.add_argument("--out", metavar="DIR", type=Path, help="folder for results and report")
    parser.add_argument(
        "--retry", action="store_true", help="also retry trials that an earlier run set aside"
    )
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")


def cluster_from(options: argparse.Namespace) -> ClusterSpec:
    """Build the cluster's specification from `add_machine_options`."""
    names = ("workers", "scheduler", "tls_ca", "tls_cert", "tls_key")
    return ClusterSpec(**{name: getattr(options, name) for name in names})


def trial_grid_from(options: argparse.Namespace) -> dict[str, Any]:
    """Convert options of `add_trial_options` to fields of an experiment; None where not given."""
    return {
        "seeds": options.seeds,
        "seed": options.seed,
        "simulator": options.simulator,
        "gaits": _join_values(options.gait, _gaits),
        "observations": _join_values(options.observation, _observations),
        "robots": _join_values(options.robot, _robots),
    }


def _join_values(
    texts: Sequence[str] | None, read: Callable[[str], Sequence[T]]
) -> tuple[T, ...] | None:
    """Join the values of an option that may be repeated."""
    return None if texts is None else tuple(value for text in texts for value in read(text))


def _gaits(text: str) -> Sequence[str | GaitSpec]:
    if text == "all":
        return list(PAPER_GAITS)
    return [read_gait(part) for part in _parts(text)]


def _observations(text: str) -> Sequence[str]:
    named = {"both": PAPER_OBSERVATIONS, "all": OBSERVATIONS}
    return named[text] if text in named else split(text)


def _robots(text: str) -> Sequence[Robot]:
    return [read_robot(part) for part in _parts(text)]


def _parts(text: str) -> list[str]:
    return [text] if text.lstrip().startswith("{") else split(text)
