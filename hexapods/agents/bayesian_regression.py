"""Bayesian linear regression with a Gaussian prior (Bishop 2006, §3.3.1)."""

from collections.abc import Mapping

import numpy as np

from hexapods.domain.types import FloatArray

_SUMS, _BLOCK = 8, 128
"""NumPy's pairwise summation adds up to 128 numbers in 8 interleaved sums."""


class BayesianRegression:
    """Linear regression with a Gaussian prior of the weights and known noise.

    Posterior precision Λ = Λ₀ + XᵀX / σ², covariance Λ⁻¹, mean Λ⁻¹ (Λ₀ m₀ + Xᵀr / σ²). With a
    forgetting factor below 1 the evidence XᵀX, Xᵀr decays geometrically, and the deviation of a
    weight without new outcomes returns to that of the prior.

    Args:
        mean: prior mean m₀ of the weights, (d,).
        deviation: prior standard deviation of each weight, independent, (d,).
        noise: standard deviation σ of an outcome.
        forgetting: share of the evidence that remains at each further outcome.

    Attributes:
        mean: posterior mean of the weights, (d,).
        covariance: posterior covariance of the weights, (d, d).
        moments: XᵀX of the evidence, (d, d).
        products: Xᵀr of the evidence, (d,).
    """

    def __init__(
        self, mean: FloatArray, deviation: FloatArray, noise: float, forgetting: float = 1.0
    ) -> None:
        self._prior_mean, self._prior_precision = mean, deviation**-2.0
        self._variance, self._forgetting = noise * noise, forgetting
        self.moments, self.products = np.zeros((len(mean), len(mean))), np.zeros(len(mean))
        self.set_evidence(self.moments, self.products)

    def expected(self, features: FloatArray) -> FloatArray:
        """Return the expected outcomes, (n,), for features (n, d)."""
        # Elementwise, because the last bits of BLAS results depend on the shape.
        outcomes: FloatArray = (features * self.mean).sum(1)
        return outcomes

    def deviation(self, features: FloatArray) -> FloatArray:
        """Return the posterior standard deviations of the expected outcomes, (n,)."""
        variance = np.einsum("nd,de,ne->n", features, self.covariance, features)
        deviations: FloatArray = np.sqrt(np.maximum(variance, 0.0))
        return deviations

    def update(self, features: FloatArray, outcome: float) -> None:
        """Learn one outcome for features (d,)."""
        share = self._forgetting
        self.set_evidence(
            share * self.moments + features[:, None] * features,
            share * self.products + features * outcome,
        )

    def discount(self, share: float) -> None:
        """Forget all but a share of the evidence, so that the prior's uncertainty returns."""
        self.set_evidence(share * self.moments, share * self.products)

    def set_evidence(self, moments: FloatArray, products: FloatArray) -> None:
        """Replace the evidence, and compute the posterior from it."""
        self.moments, self.products = moments, products
        precision = np.diag(self._prior_precision) + moments / self._variance
        self.covariance = np.linalg.inv(precision)
        weighted = self._prior_precision * self._prior_mean + products / self._variance
        self.mean = (self.covariance * weighted).sum(1)


def sum_rule(products: Mapping[int, str], count: int) -> str:
    """Return the sum of a few of `count` numbers, in the order in which NumPy adds them.

    All other numbers are 0. NumPy adds pairwise: up to seven numbers one by one, up to 128 in eight
    sums of every eighth number, and more in halves (`pairwise_sum` in its loops_utils.h).

    Args:
        products: text of each number that is not 0, by its index.
        count: number of all numbers.
    """
    if count < _SUMS:
        return _plus(*(products[index] for index in sorted(products)))
    if count > _BLOCK:
        half = count // 2 - count // 2 % _SUMS
        first = {index: text for index, text in products.items() if index < half}
        second = {index - half: text for index, text in products.items() if index >= half}
        return _plus(sum_rule(first, half), sum_rule(second, count - half))
    end = count - count % _SUMS
    sums = [
        _plus(*(products[index] for index in range(begin, end, _SUMS) if index in products))
        for begin in range(_SUMS)
    ]
    while len(sums) > 1:
        sums = [_plus(*sums[place : place + 2]) for place in range(0, len(sums), 2)]
    return _plus(*sums, *(products[index] for index in range(end, count) if index in products))


def _plus(*summands: str) -> str:
    """Return the sum of the summands from the left; sums among them are in parentheses."""
    first, *further = [summand for summand in summands if summand] or [""]
    return " + ".join(
        [first, *(f"({summand})" if " + " in summand else summand for summand in further)]
    )
