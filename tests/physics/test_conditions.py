"""Conditions of a robot and the ground in MuJoCo, and that walks in it repeat to the last bit."""

from dataclasses import replace

import numpy as np
import pytest

from hexapods.domain.disturbances import (
    DeadBand,
    Delay,
    Disturbance,
    Friction,
    Limp,
    Lost,
    Patch,
    Payload,
    Push,
    Repair,
    Rough,
    Slope,
    Stuck,
    Weak,
)
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.observation import legal_actions
from hexapods.domain.posture import has_fallen
from hexapods.domain.robot import Robot
from hexapods.domain.terrain import ROUGH_PERIOD_M, rough_heights
from hexapods.domain.types import Action, FloatArray
from hexapods.domain.world import WORLDS, World
from hexapods.physics.mjcf import compile_model
from hexapods.physics.mujoco_simulator import MujocoSimulator, MujocoState

STUCK = Stuck(leg=2, joint="femur", angle_rad=-0.9)


def build(*disturbances: Disturbance, threads: int = 1) -> MujocoSimulator:
    robot = Robot()
    gait = resolve("left-right-origin", robot.azimuths_deg)
    return MujocoSimulator(robot, gait, FootGrid(), threads, World(disturbances))


def walk(simulator: MujocoSimulator, steps: int = 12) -> list[MujocoState]:
    """Take the first steps of a walk forward."""
    states = [simulator.rest()]
    for step in range(steps):
        states.append(simulator.step(states[-1], Action(step % 3, 2)).state)
    return states


def joints(state: MujocoState) -> FloatArray:
    return state.row[8:26].reshape(6, 3)


def test_nothing_changes_before_it_begins_nor_after_it_ends_if_it_never_touched() -> None:
    calm = walk(build())
    late = walk(build(Limp(legs=(1, 4), at_step=6)))

    for step in range(7):
        assert (late[step].row == calm[step].row).all()
    assert (late[7].row != calm[7].row).any()


@pytest.mark.parametrize("name", [name for name in WORLDS if name not in ("flat", "noise")])
def test_every_named_world_changes_a_walk(name: str) -> None:
    calm, bitten = build(), build(*WORLDS[name].world.disturbances)

    assert len(bitten.rest().row) == len(calm.rest().row)
    assert bitten.model.nbody == calm.model.nbody
    assert walk(bitten)[-1].distance_m != walk(calm)[-1].distance_m


def test_limp_legs_do_not_obey() -> None:
    obeyed, dragged = walk(build())[-1], walk(build(Limp(legs=(1,))))[-1]

    assert joints(dragged)[1:] == pytest.approx(joints(obeyed)[1:], abs=0.15)
    assert np.abs(joints(dragged)[0] - joints(obeyed)[0]).max() > 0.3


def test_a_stuck_joint_holds_its_angle() -> None:
    for state in walk(build(STUCK))[1:]:
        assert joints(state)[1, 1] == pytest.approx(-0.9, abs=0.1)


def test_a_lost_leg_weighs_nothing_and_touches_nothing() -> None:
    model = build(Lost(legs=(2,))).model

    assert model.body_mass.sum() == pytest.approx(2.16 - 0.16, abs=1e-4)
    assert model.geom("leg2_foot").contype == 0
    assert model.geom("leg3_foot").contype == 1


def test_weak_servos_and_payload_are_in_the_model() -> None:
    simulator = build(Weak(legs=(3,), torque_share=0.5), Payload(kg=1, x_m=0.05, y_m=0.02))
    model, forward = simulator.model, np.deg2rad(simulator.gait.forward_deg)

    assert model.actuator("leg3_femur").forcerange == pytest.approx((-0.75, 0.75))
    assert model.actuator("leg2_femur").forcerange == pytest.approx((-1.5, 1.5))
    assert model.body_mass.sum() == pytest.approx(3.16)
    x, y = model.geom("payload").pos[:2]
    assert x * np.cos(forward) + y * np.sin(forward) == pytest.approx(0.02)
    assert x * np.sin(forward) - y * np.cos(forward) == pytest.approx(0.05)


@pytest.mark.parametrize(
    ("towards", "pulled"), [(0, (0, -1)), (90, (1, 0)), (180, (0, 1)), (-90, (-1, 0))]
)
def test_a_slope_rises_in_its_direction(towards: float, pulled: tuple[int, int]) -> None:
    gravity = build(Slope(degrees=30, direction_deg=towards)).model.opt.gravity

    assert np.linalg.norm(gravity) == pytest.approx(9.81)
    assert gravity[:2] == pytest.approx(np.multiply(pulled, 9.81 / 2))


def test_friction_holds_for_all_that_touches_the_ground() -> None:
    model = build(Friction(value=0.3)).model

    assert model.geom("leg1_foot").friction[0] == model.geom("torso").friction[0] == 0.3
    loaded = build(Friction(value=0.3), Payload(kg=1)).model
    assert loaded.geom("payload").friction[0] == 0.3


def test_a_patch_is_slippery_only_where_it_is() -> None:
    calm = walk(build())
    far = walk(build(Patch(from_m=5, to_m=6, friction=0.02)))
    under = walk(build(Patch(from_m=-1, to_m=1, friction=0.02)))
    ice = walk(build(Friction(value=0.02)))

    assert far[-1].distance_m == pytest.approx(calm[-1].distance_m, abs=0.002)
    assert under[-1].distance_m == pytest.approx(ice[-1].distance_m, abs=0.01)
    assert abs(under[-1].distance_m - calm[-1].distance_m) > 0.02


def test_patches_may_touch_each_other() -> None:
    first, second = (Patch(from_m=a, to_m=a + 0.1, friction=0.1) for a in (0.1, 0.2))
    assert build(first, second).rest().steps == 0


def test_a_jammed_joint_holds_in_a_leg_without_power() -> None:
    for state in walk(build(STUCK, Limp(legs=(2,))))[1:]:
        assert joints(state)[1, 1] == pytest.approx(-0.9, abs=0.1)


def test_bumps_that_appear_bury_no_foot() -> None:
    early, late = (walk(build(Rough(amplitude_m=0.04, at_step=at)), 10)[-1] for at in (0, 3))
    assert late.row[3] == pytest.approx(early.row[3], abs=0.02)


def test_ground_after_bumps_is_where_it_was() -> None:
    patch = Patch(from_m=-1, to_m=1, friction=0.02, at_step=1)
    simulator = build(Rough(amplitude_m=0.01, until_step=1), patch)
    state = simulator.step(simulator.rest(), Action(0, 2)).state
    row = state.row.copy()
    row[2] -= ROUGH_PERIOD_M
    moved = replace(state, row=row, origin_m=(0.0, ROUGH_PERIOD_M))
    ends = [simulator.step(start, Action(1, 2)).state for start in (state, moved)]

    assert ends[0].distance_m == pytest.approx(ends[1].distance_m, abs=1e-9)
    assert ends[1].origin_m == (0.0, 0.0)


def test_a_push_moves_the_robot_in_its_direction_and_is_not_foreseen() -> None:
    calm, pushed = build(), build(Push(impulse_ns=2, direction_deg=90, at_step=1))
    before, after = (walk(simulator, 2) for simulator in (calm, pushed))

    assert (before[1].row == after[1].row).all()
    assert after[2].row[1] < before[2].row[1] - 0.005  # to the left is −x
    foreseen = pushed.expand([after[1]], [Action(1, 2)]).states[0]
    assert (foreseen.row == before[2].row).all()


def test_delayed_commands_arrive_after_the_step() -> None:
    simulator = build(Delay(seconds=0.04))
    end = simulator.step(simulator.rest(), Action(0, 2)).state
    (commands,) = build().commands([build().rest()], [Action(0, 2)])

    assert end.delayed is not None
    assert (end.delayed == commands[-10:]).all()


def test_a_dead_band_keeps_servos_from_small_changes() -> None:
    lazy, calm = build(DeadBand(radians=0.2)), build()
    action = Action(0, 2)

    def turned(simulator: MujocoSimulator) -> FloatArray:
        rest = simulator.rest()
        moved = joints(simulator.step(rest, action).state) - joints(rest)
        return np.asarray(np.abs(moved).max(1))

    assert turned(calm).min() > 0.01
    assert turned(lazy).min() < 0.01


def test_rough_ground_repeats_and_follows_its_seed() -> None:
    heights = rough_heights(Rough(amplitude_m=0.02, seed=1))

    assert heights.min() >= 0
    assert 0.015 < heights.max() <= 0.02
    assert (heights == rough_heights(Rough(amplitude_m=0.02, seed=1))).all()
    assert (heights != rough_heights(Rough(amplitude_m=0.02, seed=2))).any()
    rise = np.abs(heights - np.roll(heights, 1, 0)).max()
    assert np.abs(heights[0] - heights[-1]).max() <= rise


def test_a_walk_over_rough_ground_goes_on_after_a_period() -> None:
    simulator = build(Rough(amplitude_m=0.01))
    start = simulator.rest()
    row = start.row.copy()
    row[2] += ROUGH_PERIOD_M
    period_later = MujocoState(row, start.feet, start.distance_m + ROUGH_PERIOD_M)

    near, far = (simulator.step(s, Action(0, 2), record=True) for s in (start, period_later))

    assert far.reward_m == pytest.approx(near.reward_m, abs=1e-9)
    assert far.state.distance_m == pytest.approx(near.state.distance_m + ROUGH_PERIOD_M)
    assert simulator.pose(far.state)[1] == pytest.approx(far.state.distance_m)
    assert far.motion is not None
    assert far.motion.qpos[-1, 1] == pytest.approx(far.state.distance_m, abs=1e-5)


EVENTFUL = (
    Limp(legs=(1, 4), at_step=2),
    Delay(seconds=0.02, at_step=3),
    Rough(amplitude_m=0.01, at_step=4),
    Push(impulse_ns=1, at_step=5),
    Repair(legs=(1, 4), at_step=6),
)


def test_a_stored_state_continues_to_the_last_bit() -> None:
    unbroken = walk(build(*EVENTFUL), 8)
    for step in (3, 4, 6):
        simulator = build(*EVENTFUL)
        state = simulator.load(build(*EVENTFUL).dump(unbroken[step]))
        for later in range(step, 8):
            state = simulator.step(state, Action(later % 3, 2)).state
        assert (state.row == unbroken[-1].row).all()
        assert state.distance_m == unbroken[-1].distance_m


def test_look_ahead_of_many_steps_equals_single_steps_at_any_thread_count() -> None:
    states = walk(build(*EVENTFUL), 4)
    actions = legal_actions((0, 0, 0), 5)[: len(states)]
    singles = [build(*EVENTFUL).step(s, a).state for s, a in zip(states, actions, strict=True)]

    for threads in (1, 2):
        together = build(*EVENTFUL, threads=threads).expand(states, actions)
        for single, batched in zip(singles, together.states, strict=True):
            assert (single.row == batched.row).all()


def test_a_search_can_hold_the_conditions_of_one_step() -> None:
    simulator = build(Limp(legs=(1, 4), at_step=1))
    rest = simulator.rest()

    unaware = simulator.expand([rest], [Action(0, 2)], as_of=0).states[0]
    aware = simulator.expand([rest], [Action(0, 2)], as_of=1).states[0]

    assert (unaware.row == build().step(build().rest(), Action(0, 2)).state.row).all()
    assert (aware.row != unaware.row).any()


def test_a_robot_without_power_lies_on_the_ground() -> None:
    simulator = build(Limp(legs=(1, 2, 3, 4, 5, 6), at_step=1))
    fallen = [has_fallen(Robot(), simulator.pose(state).tolist()) for state in walk(simulator, 6)]

    assert not any(fallen[:2])
    assert fallen[-1]
    for state in walk(build()):
        assert not has_fallen(Robot(), build().pose(state).tolist())


def test_the_torso_does_not_sink_into_the_ground() -> None:
    (lying,) = walk(build(Lost(legs=(1, 2, 3, 4, 5, 6), at_step=0)), 1)[-1:]

    assert lying.row[3] == pytest.approx(Robot().torso_half_height_m, abs=0.002)


def test_models_are_cached_by_conditions() -> None:
    limp = World((Limp(legs=(1,), at_step=4),))

    assert compile_model(Robot(), limp.as_of(0)) is compile_model(Robot())
    assert compile_model(Robot(), limp.as_of(4)) is compile_model(Robot(), limp.as_of(9))


def test_a_leg_that_is_not_there_is_refused() -> None:
    with pytest.raises(InvalidInput, match="there is no leg 9"):
        build(Limp(legs=(9,)))
