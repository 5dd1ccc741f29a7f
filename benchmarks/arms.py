"""The arms that benches run on: those that are shipped, and a UR5e whose flange sensor is noisier or is not there."""

from collections.abc import Callable

from msgspec.structs import replace

from app.files.library import load_arm, robots
from sim.arm.arm_file import Arm, Channels, SensorNumbers

USUAL = "ur5e"
"""The arm whose results are in docs/results."""

BENCHES = frozenset(
    {"drift", "drop", "free_drive_forces", "guided", "intent", "link_hands", "observer", "payload", "use"},
)
"""Those that run on any arm; the others choose their own."""

NOISIER = 3.0  # times
HEAVIEST = 5.0  # [kg] that benches hang on an arm that can bear it


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
