"""Five-bar legs, each of which a file describes as two chains."""

from collections.abc import Mapping

import numpy as np
import pytest

from hexapods.imports.choices import Choices
from tests.imports.robots import FOUR, Mounts, read

CHAINS = {"L": (-0.02, 0.9, -1.4), "R": (0.02, -0.9, 1.4)}
"""Of both chains of a leg: how far to the left, and angles of its links from straight down."""


def five_bars(
    legs: Mounts = FOUR, chains: Mapping[str, tuple[float, float, float]] = CHAINS
) -> str:
    """Return a robot whose legs are pairs of chains of two joints in parallel planes."""
    bodies = "".join(
        f"""<body name="{leg}_{chain}_upper" pos="{x} {y + left} 0" euler="0 {upper} 0">
          <joint name="{leg}_{chain}_motor" axis="0 1 0" range="-1.5 1.5"/>
          <geom type="capsule" fromto="0 0 0 0 0 -0.1" size="0.008" mass="0.1"/>
          <body name="{leg}_{chain}_lower" pos="0 0 -0.1" euler="0 {lower} 0">
            <joint name="{leg}_{chain}_knee" axis="0 1 0" range="-2 2"/>
            <geom type="capsule" fromto="0 0 0 0 0 -0.19" size="0.006" mass="0.1"/>
            <geom name="{leg}_{chain}" type="sphere" pos="0 0 -0.2" size="0.01" mass="0.01"/>
          </body></body>"""
        for leg, (x, y) in legs.items()
        for chain, (left, upper, lower) in chains.items()
    )
    return f"""<mujoco><compiler angle="radian"/><worldbody><body name="trunk" pos="0 0 0.3">
      <freejoint/><geom type="box" size="0.2 0.08 0.03" mass="3"/>{bodies}</body></worldbody>
      </mujoco>"""


def test_two_chains_to_a_foot_are_one_leg() -> None:
    robot = read(five_bars())

    assert {leg.foot for leg in robot.legs} == {"FL_R", "FR_L", "RL_R", "RR_L"}  # the outer ones
    (note,) = [note for note in robot.notes if "two chains end at each foot" in note.text]
    assert set(note.parts) == {f"{foot}_lower" for foot in ("FL_L", "FR_R", "RL_L", "RR_R")}
    assert len(robot.feet) == 8
    assert robot.mass_kg == pytest.approx(3 + 8 * 0.21)
    torso = robot.model.links[0]
    assert torso.mass_kg == pytest.approx(3 + 4 * 0.21)
    assert len(torso.geoms) == 1
    if torso.mesh is not None:
        assert np.ptp(torso.mesh.arrays()[0], axis=0)[2] < 0.07  # the second chains are not drawn
    assert not any("joints of no leg" in text for text in robot.repairs)


def test_both_chains_are_legs_if_a_person_says_so() -> None:
    offer = next(note.offer for note in read(five_bars()).notes if "two chains" in note.text)
    assert offer is not None

    robot = read(five_bars(), choices=offer)

    assert len(robot.legs) == 8
    assert not any("two chains" in text for text in robot.guesses)
    inner = read(five_bars(), choices=Choices(feet=("FL_L", "FR_R", "RL_L", "RR_R")))
    assert len(inner.legs) == 4


@pytest.mark.parametrize(
    "text",
    [
        five_bars(chains={"L": (0.0, 0.5, -1.0)}),
        # Left and right of a narrow robot.
        five_bars({leg: (x, 0.3 * y) for leg, (x, y) in FOUR.items()}, {"L": (0.0, 0.5, -1.0)}),
        # Three legs a side, one behind the other.
        five_bars({f"{x}_{y}": (0.1 * x, 0.1 * y) for x in (0, 1, 2) for y in (-1, 1)},
                  {"L": (0.0, 0.5, -1.0)}),
    ],
)  # fmt: skip
def test_legs_that_only_stand_close_together_stay(text: str) -> None:
    robot = read(text)

    assert len(robot.legs) in (4, 6)
    assert not any("two chains" in note for note in robot.guesses)
