"""An Optuna study by ask and tell; the only module that imports Optuna.

The sampler is a tree-structured Parzen estimator (Bergstra et al., "Algorithms for hyper-parameter
optimization", 2011). Nothing is stored: the same seed and the same values told give the same study,
so that one that was stopped is told its results again.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import optuna
from optuna.distributions import (
    BaseDistribution,
    CategoricalDistribution,
    FloatDistribution,
    IntDistribution,
)
from optuna.trial import TrialState

from hexapods.domain.settings import Value
from hexapods.experiments.tuning.ranges import SearchRange


class Study:
    """Asks for values of settings, and is told how good they are; higher is better.

    Args:
        ranges: where to search.
        first: the values that are asked for first.
        seed: seed of the sampler.
    """

    def __init__(
        self, ranges: Sequence[SearchRange], first: Mapping[str, Value], seed: int
    ) -> None:
        optuna.logging.set_verbosity(optuna.logging.ERROR)
        self._ranges = {one.name: one for one in ranges}
        self._distributions = {one.name: _distribution(one) for one in ranges}
        self._study = optuna.create_study(
            direction="maximize", sampler=optuna.samplers.TPESampler(seed=seed % 2**32)
        )
        self._first = dict(first)
        self._study.enqueue_trial(self._first)

    def ask(self) -> tuple[int, dict[str, Any]]:
        """Return the next number, counted from 0, and values to try."""
        trial = self._study.ask(self._distributions)
        if trial.number == 0:
            return 0, self._first
        return trial.number, {
            name: one.rounded(trial.params[name]) for name, one in self._ranges.items()
        }

    def tell(self, number: int, value: float | None) -> None:
        """Tell how good the values of a number were; None if they could not be tried."""
        if value is None:
            self._study.tell(number, state=TrialState.FAIL)
        else:
            self._study.tell(number, value)


def _distribution(one: SearchRange) -> BaseDistribution:
    if one.choices:
        return CategoricalDistribution(one.choices)
    if one.is_whole:
        return IntDistribution(int(one.low), int(one.high), log=one.is_logarithmic)
    return FloatDistribution(one.low, one.high, log=one.is_logarithmic)
