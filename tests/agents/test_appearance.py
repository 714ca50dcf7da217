"""Names of lanes: the agent's title, and its settings in short."""

from typing import Any

import pytest

from hexapods.agents.appearance import name_of


@pytest.mark.parametrize(
    ("agent", "settings", "keep_learning", "name"),
    [
        ("greedy", {}, False, "Greedy"),
        ("beam", {"width": 8, "depth": 3}, False, "Beam, width 8, depth 3"),
        ("q-learning", {"alpha": 0.3, "gamma": 0.5}, None, "Q-learning, γ 0.5"),
        ("q-learning", {"alpha": 0.3}, True, "Q-learning, keeps learning"),
        ("my.module:Agent", {"width": 8}, True, "Agent, keeps learning"),
    ],
)
def test_lane_is_named_by_its_agent_and_what_is_special_about_it(
    agent: str, settings: dict[str, Any], keep_learning: bool | None, name: str
) -> None:
    assert name_of(agent, settings, keep_learning).replace("\u00a0", " ") == name
