"""Colours of what happens to a robot and to its ground; the same in the light and dark theme."""

from hexapods.domain.disturbances import Friction, Limp, Lost, Patch, Stuck, Weak
from hexapods.domain.legs import Joint
from hexapods.domain.world import World
from hexapods.drawing.colormap import Rgb, mix

HOLLOW: Rgb = (52, 60, 74)
TOP: Rgb = (134, 144, 160)
"""Colours of rough ground: its lowest points and its highest bumps."""
ICE: Rgb = (64, 160, 228)
"""Ground with less friction than before."""
GRIP: Rgb = (150, 104, 62)
"""Ground with more friction than before."""
PAYLOAD: Rgb = (186, 190, 196)
RED: Rgb = (226, 33, 52)
"""Pushes, and links whose joint is stuck."""
UPHILL: Rgb = (245, 196, 60)
_NO_TORQUE: Rgb = (126, 130, 136)
_HIGHEST_SHARE = 0.7
"""Share of grey of a leg with hardly any torque; limp ones are grey altogether."""


def link_color(color: Rgb, conditions: World, joint: Joint) -> Rgb | None:
    """Return the colour of a leg's link; None if the leg is lost.

    A link is the greyer the less torque its servos have; one whose joint is stuck is red.

    Args:
        color: of the link as it was built.
        conditions: what holds, a result of `World.as_of`.
        joint: the joint that moves the link.
    """
    for disturbance in conditions.disturbances:
        if isinstance(disturbance, Lost) and joint.leg in disturbance.legs:
            return None
        if isinstance(disturbance, Limp) and joint.leg in disturbance.legs:
            return _NO_TORQUE
        if isinstance(disturbance, Weak) and joint.leg in disturbance.legs:
            color = mix(color, _NO_TORQUE, _HIGHEST_SHARE * (1 - disturbance.torque_share))
    stuck = conditions.all_of(Stuck)
    return (
        RED
        if any(
            (disturbance.leg, disturbance.joint) == (joint.leg, joint.name) for disturbance in stuck
        )
        else color
    )


def ground_color(ground: Friction | Patch, friction: float) -> Rgb:
    """Return the colour of ground that has another friction than the one around it."""
    ground_friction = ground.friction if isinstance(ground, Patch) else ground.value
    return ICE if ground_friction < friction else GRIP
