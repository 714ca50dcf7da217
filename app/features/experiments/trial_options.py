"""Options of experiments and sweeps: trial grid, machines, results folder."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypeVar

from cyclopts import Parameter

from app.cli.options import AsJson, WholeNumber, Workers, read_gait, read_robot
from app.cli.setting_options import split
from hexapods.domain.gait import NAMED_GAITS, PAPER_GAITS, GaitSpec
from hexapods.domain.observation import OBSERVATIONS, PAPER_OBSERVATIONS
from hexapods.domain.robot import PRESETS, Robot
from hexapods.experiments.cluster import ClusterSpec
from hexapods.runs.config import SimulatorName, usable_agents

T = TypeVar("T")
Pem = Annotated[str | None, Parameter(metavar="PEM")]


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class TrialOptions:
    """Options of a trial grid; the experiment's defaults hold for those that are not given.

    Attributes:
        agent: agents to compare, or my.module:Agent; repeat, or separate by commas
        seeds: number of seeds per learner (default 30)
        seed: root seed from which all others are spawned (default 0)
        simulator: simulator (default mujoco)
    """

    agent: Annotated[tuple[str, ...], Parameter(completer=lambda _: usable_agents())] = ()
    seeds: WholeNumber | None = None
    seed: WholeNumber | None = None
    gait: Annotated[
        tuple[str, ...],
        Parameter(
            completer=lambda _: [*NAMED_GAITS],
            help="all (the paper's four, default), one or more of "
            f"{', '.join(NAMED_GAITS)}, or JSON",
        ),
    ] = ()
    observation: Annotated[
        tuple[str, ...],
        Parameter(
            completer=lambda _: OBSERVATIONS,
            help=f"both (the paper's two), all, or one or more of {', '.join(OBSERVATIONS)} "
            "(default both in experiments, measured in sweeps)",
        ),
    ] = ()
    robot: Annotated[
        tuple[str, ...],
        Parameter(
            completer=lambda _: [*PRESETS],
            help=f"one or more of {', '.join(PRESETS)}, a stored one, a TOML file, or JSON "
            "(default stiff; stiff,compliant for table1)",
        ),
    ] = ()
    simulator: SimulatorName | None = None

    def fields(self) -> dict[str, Any]:
        """Return fields of an experiment; None where nothing is given.

        Raises:
            HexapodError: if a gait or robot is not valid.
        """
        return {
            "agents": _join_values(self.agent, split),
            "seeds": self.seeds,
            "seed": self.seed,
            "simulator": self.simulator,
            "gaits": _join_values(self.gait, _gaits),
            "observations": _join_values(self.observation, _observations),
            "robots": _join_values(self.robot, _robots),
        }


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class ExecutionOptions:
    """Options for workers or cluster, results folder and output.

    Attributes:
        scheduler: scheduler of a Dask cluster, tcp://HOST:PORT or tls://…
        tls_ca: CA, for a tls:// scheduler
        tls_cert: client certificate, for a tls:// scheduler
        tls_key: key of the client certificate, for a tls:// scheduler
        out: folder for results and report
        retry: also retry trials that an earlier run set aside
        as_json: print the summary as JSON
    """

    workers: Workers = None
    scheduler: Annotated[str | None, Parameter(metavar="ADDRESS")] = None
    tls_ca: Pem = None
    tls_cert: Pem = None
    tls_key: Pem = None
    out: Annotated[Path | None, Parameter(metavar="DIR")] = None
    retry: bool = False
    as_json: AsJson = False

    def cluster(self) -> ClusterSpec:
        """Return the specification of the workers or the cluster."""
        return ClusterSpec(
            workers=self.workers,
            scheduler=self.scheduler,
            tls_ca=self.tls_ca,
            tls_cert=self.tls_cert,
            tls_key=self.tls_key,
        )


def _join_values(texts: Sequence[str], read: Callable[[str], Sequence[T]]) -> tuple[T, ...] | None:
    """Join the values of an option that may be repeated; None without any."""
    return tuple(value for text in texts for value in read(text)) if texts else None


def _gaits(text: str) -> Sequence[str | GaitSpec]:
    if text == "all":
        return list(PAPER_GAITS)
    return [read_gait(entry) for entry in _entries(text)]


def _observations(text: str) -> Sequence[str]:
    named = {"both": PAPER_OBSERVATIONS, "all": OBSERVATIONS}
    return named[text] if text in named else split(text)


def _robots(text: str) -> Sequence[Robot]:
    return [read_robot(entry) for entry in _entries(text)]


def _entries(text: str) -> list[str]:
    return [text] if text.lstrip().startswith("{") else split(text)
