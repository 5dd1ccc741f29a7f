"""The arms that benches run on: those that are shipped, and a UR5e whose flange sensor is noisier or is not there.

Bars and hands are those of the usual arm. What of them another arm can be asked for is said here, from the arm's own numbers: a
hand is as strong as the payload is heavy; what rubs more asks for more; what only joints feel has to be more than they may miss.
"""

from collections.abc import Callable
from typing import Literal

import numpy as np
from msgspec.structs import replace

from app.files.library import load_arm, robots
from sim.arm.arm_file import Arm, Channels, SensorNumbers
from sim.arm.frames import joint_frames, placements
from sim.arm.joint_constants import ripple_torque

USUAL = "ur5e"
"""The arm whose results are in docs/results."""

BENCHES = frozenset(
    {"drift", "drop", "free_drive_forces", "guided", "intent", "link_hands", "observer", "payload", "use"},
)
"""Those that run on any arm; the others choose their own."""

NOISIER = 3.0  # times
HEAVIEST = 5.0  # [kg] that benches hang on an arm that can bear it
LEVER = 0.2
"""Of a push on at least one joint [m]: a hand that pushes an arm through its axes turns nothing; a skin alone would feel it."""
Part = Literal["elbow", "flange", "wrist"]


def _without_sensor(sensors: SensorNumbers) -> SensorNumbers:
    """With the flange sensor go the accelerometers and gyros at its faces."""
    return replace(sensors, force_torque=None, accelerometer=None, gyro=None)


def _noisy_sensor(sensors: SensorNumbers) -> SensorNumbers:
    """The controller reads the noise from the same numbers, as from an arm's file."""
    own = sensors.force_torque
    assert own is not None
    return replace(sensors, force_torque=replace(own, force=_noisier(own.force), torque=_noisier(own.torque)))


def _noisier(channels: Channels) -> Channels:
    return replace(channels, noise=NOISIER * channels.noise)


VARIANTS: dict[str, Callable[[SensorNumbers], SensorNumbers]] = {
    f"{USUAL}-noisy-sensor": _noisy_sensor,
    f"{USUAL}-without-sensor": _without_sensor,
}
"""What else than a shipped arm there is: the usual one with other sensors."""


def names() -> list[str]:
    """All arms."""
    return [*robots(), *VARIANTS]


def load(name: str) -> Arm:
    """The arm of that name."""
    if name not in VARIANTS:
        return load_arm(name)
    arm = load_arm(USUAL)
    return replace(arm, sensors=VARIANTS[name](arm.sensors))


def senses(name: str) -> bool:
    """The arm has a flange sensor."""
    return load(name).sensors.force_torque is not None


def heaviest(name: str) -> float:
    """The largest payload that benches hang on an arm [kg]."""
    return min(HEAVIEST, load(name).payload)


def strength(name: str) -> float:
    """Of a hand on an arm, as a share of the same hand's on the usual one.

    Where an arm bears less than others a hand is as much weaker, or its shoulder would not withstand it, and its joints would be
    driven to their limits.
    """
    return heaviest(name) / HEAVIEST


def rubs(name: str, part: Part, speed: float) -> float:
    """What friction asks of a hand that leads a part at a speed [m/s], as a share of the same on the usual arm, at least 1.

    A hand does not get less to do for a light arm. The wrist turns in place, so its speed is an angular one [rad/s].
    """
    own, usual = (friction_at(load(each), part, speed) for each in (name, USUAL))
    return max(own / usual, 1.0)


def friction_at(arm: Arm, part: Part, speed: float) -> float:
    """Mean over the joints that move a part: their friction over its furthest lever [N]; of the wrist their friction [N·m]."""
    elbow = arm.chain.elbow
    upper_arm = float(np.linalg.norm(placements(arm)[2 : elbow + 1, :3, 3], axis=1).sum())
    joints, lever = {
        "elbow": (slice(0, elbow), upper_arm),
        "flange": (slice(0, elbow + 1), arm.reach),
        "wrist": (slice(elbow + 1, None), 1.0),
    }[part]
    friction = arm.frictions
    return float(np.mean([np.interp(speed / lever, friction.speed, torque) for torque in friction.torque[joints]])) / lever


def shoulder_height(arm: Arm) -> float:
    """Height of the second joint's origin above the base's [m]."""
    return float(joint_frames(arm, np.zeros(arm.n))[1][2, 3])


def missed(name: str) -> float:
    """What joints may miss of a torque where no flange sensor tells a hand: the ripple of their encoders, at most [N·m]."""
    return 0.0 if senses(name) else float(ripple_torque(load(name)).max())
