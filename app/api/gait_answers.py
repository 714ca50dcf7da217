"""Response models of the gait analysis of a run. Times are robot time [s]: motion only."""

from typing import Annotated, Literal

from pydantic import Field

from app.api.answers import Answer, Count

Interval = tuple[float, float]


class LegGaitView(Answer):
    """Footfalls of a leg: when its foot is on the ground, [from s, to s], and the share of that."""

    leg: Annotated[int, Field(ge=1)]
    stance: list[Interval]
    duty_factor: Annotated[float, Field(ge=0, le=1)]


class CycleView(Answer):
    """The sequence of steps that the walk repeats at its end, at least three times.

    `first_step` is counted from 0; `actions` are [pair, cell]; `advance_m` is of one period.
    """

    steps: Annotated[int, Field(ge=1)]
    period_s: float
    first_step: Count
    repeats: Annotated[int, Field(ge=3)]
    advance_m: float
    actions: list[tuple[int, int]]


class PostureView(Answer):
    """The torso over time: its centre's height over flat ground, pitch and roll.

    Pitch is positive with the front up, roll with the left side up. Ranges are of all recorded
    poses, which in a long window are more than the samples.
    """

    time_s: list[float]
    height_m: list[float]
    pitch_deg: list[float]
    roll_deg: list[float]
    height_range_m: Interval
    pitch_range_deg: Interval
    roll_range_deg: Interval


class ServoEffortView(Answer):
    """Torque, positive mechanical work and cost of transport of the servos.

    Samples of `torque_nm` are the largest torque of any servo since the sample before, those of
    `power_w` the mean power of all. `cost_of_transport` is energy by weight and distance, null
    without distance. Losses in motors and electronics are not simulated.
    """

    time_s: list[float]
    torque_nm: list[float]
    power_w: list[float]
    largest_torque_nm: float
    torque_limit_nm: float
    energy_j: float
    mean_power_w: float
    cost_of_transport: float | None


class GaitFiguresView(Answer):
    """Figures of a walk in the window.

    `distance_m` is along the direction that the robot faced at first; a body length is the
    diameter of the torso.
    """

    from_s: float
    to_s: float
    distance_m: float
    speed_m_s: float
    speed_body_lengths_s: float
    duty_factor: Annotated[float, Field(ge=0, le=1, description="mean of all legs")]
    mass_kg: float
    legs: list[LegGaitView]
    cycle: Annotated[CycleView | None, Field(description="null if the walk has no limit cycle")]
    posture: PostureView
    effort: Annotated[ServoEffortView | None, Field(description="null if it was not recorded")]


class GaitLaneView(Answer):
    """A robot's walk; `figures` are null if nothing of it lies in the window."""

    agent: str
    recorded_from_s: float
    recorded_to_s: float
    figures: GaitFiguresView | None
    no_effort: Annotated[
        str | None, Field(description="why there are neither torque nor energy, in a sentence")
    ]


class GaitView(Answer):
    """Gait analysis of a race, lane by lane, or of a training."""

    part: Literal["race", "practice", "evaluation"]
    step_s: Annotated[float, Field(description="duration of a step")]
    lanes: list[GaitLaneView]
