"""What a worker of the cluster does."""

import time
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from app.domain.errors import HexapodError
from app.experiments.trial import TrialConfig, TrialResult, run_trial
from app.experiments.versions import difference, versions


class OtherResults(HexapodError):
    """A worker that joined later would compute something else."""


class Done(NamedTuple):
    """What a worker answers about a trial: a result, or why there is none."""

    result: TrialResult | None
    reason: str | None
    compute_s: float


def work(configs: Sequence[TrialConfig], expected: Mapping[str, str]) -> list[Done]:
    """Run a batch of trials; this is what a worker does.

    Raises:
        OtherResults: if this worker has other versions than were expected.
    """
    differs = difference(expected, versions())
    if differs is not None:
        raise OtherResults(f"a worker that joined would compute other results: it has {differs}")
    return [_timed(config) for config in configs]


def _timed(config: TrialConfig) -> Done:
    began_s = time.perf_counter()
    result, reason = None, None
    try:
        result = run_trial(config)
    except HexapodError as error:
        reason = str(error)
    # An agent is anyone's code, and may do anything.
    except (Exception, SystemExit) as error:
        reason = f"something in it broke ({type(error).__name__}: {error})"
    return Done(result, reason, time.perf_counter() - began_s)
