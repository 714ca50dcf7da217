"""Posteriors of Bayesian linear regression, computed by hand."""

import numpy as np
import pytest

from hexapods.agents.bayesian_regression import BayesianRegression


def test_posterior_of_one_weight_by_hand() -> None:
    """Prior N(1, 2²), noise 1, outcome 3 at x = 2: precision 1/4 + 4, mean (1/4 + 6) / 4.25."""
    regression = BayesianRegression(np.array([1.0]), np.array([2.0]), noise=1.0)
    regression.update(np.array([2.0]), 3.0)

    assert regression.covariance[0, 0] == pytest.approx(1 / 4.25)
    assert regression.mean[0] == pytest.approx(6.25 / 4.25)
    assert regression.expected(np.array([[3.0]]))[0] == pytest.approx(3 * 6.25 / 4.25)
    assert regression.deviation(np.array([[3.0]]))[0] == pytest.approx(3 / np.sqrt(4.25))


def test_posterior_of_two_weights_by_hand() -> None:
    """One outcome 2 of the sum of two weights N(0, 1), noise 1: Λ = I + 11ᵀ, mean 2/3 each."""
    regression = BayesianRegression(np.zeros(2), np.ones(2), noise=1.0)
    regression.update(np.ones(2), 2.0)

    assert regression.mean == pytest.approx([2 / 3, 2 / 3])
    assert regression.covariance == pytest.approx(np.array([[2, -1], [-1, 2]]) / 3)
    together, apart = regression.deviation(np.array([[1.0, 1.0], [1.0, -1.0]]))
    assert together == pytest.approx(np.sqrt(2 / 3))
    assert apart == pytest.approx(np.sqrt(2))


def test_forgotten_evidence_brings_back_the_prior() -> None:
    regression = BayesianRegression(np.array([1.0]), np.array([2.0]), noise=1.0)
    for _ in range(4):
        regression.update(np.array([1.0]), 5.0)
    regression.discount(0.25)  # as after one outcome
    assert regression.mean[0] == pytest.approx((1 / 4 + 5) / 1.25)
    regression.discount(0.0)
    assert (regression.mean[0], regression.covariance[0, 0]) == pytest.approx((1.0, 4.0))


def test_evidence_decays_by_the_forgetting_factor() -> None:
    """Outcomes 2 and 5 at x = 1, the first kept by half: Λ = 1 + 0.5 + 1, mean (1 + 5) / 2.5."""
    regression = BayesianRegression(np.zeros(1), np.ones(1), noise=1.0, forgetting=0.5)
    regression.update(np.ones(1), 2.0)
    regression.update(np.ones(1), 5.0)
    assert regression.covariance[0, 0] == pytest.approx(1 / 2.5)
    assert regression.mean[0] == pytest.approx(6 / 2.5)
