"""What the user's hand does to the arm: a wrench at a point of a part, or a spring to a point in space."""

from typing import NamedTuple

Triple = tuple[float, float, float]
ZERO: Triple = (0.0, 0.0, 0.0)


class Push(NamedTuple):
    """A wrench on a part, for one tick."""

    part: str  # "foot", a joint's link by its joint name, "flange" (the tool-side face of its sensor), "tool"
    point: Triple  # where, in the part's frame [m]
    force: Triple  # in W [N]
    torque: Triple = ZERO  # in W [N·m]


class Pull(NamedTuple):
    """A virtual hand: spring and damper from a point of a part to a point in space, its force capped."""

    part: str
    point: Triple  # where it holds, in the part's frame [m]
    target: Triple  # where it pulls to, in W [m]
    cap: float = 50.0  # largest force [N]


Touch = Push | Pull
