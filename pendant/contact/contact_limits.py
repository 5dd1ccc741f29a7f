"""The thresholds of contact detection, from settings, payload, posture, speed and mode (CD-5, CD-11, CD-12)."""

from typing import NamedTuple

from pendant.contact.settings import BufferStatistic, ContactUse
from pendant.sensor.sensor_spec import USUAL, SensorSpec
from pendant.tick.modes import Mode

LIGHTEST = 0.3
"""Carried mass below which the ratio's threshold does not follow it: a bare flange has hardly any [kg] (CD-5)."""
ARM_SHARE = 0.3
"""Of the effective mass: a contact's ratio is minus the whole of it, so no threshold goes beyond this share (CD-5)."""
OLDER = 16
"""Samples before the newest, whose mean a clear difference is measured from: they add little noise to the newest's (CD-9)."""


class ContactLimits(NamedTuple):
    """Thresholds of all rules for one source; squares where sizes are compared squared."""

    noise_force_sq: float  # difference of two samples: below, it is noise (CD-0) [N²]
    noise_acceleration_sq: float  # [m²/s⁴]
    opposite: bool  # directions must be opposite (CD-0)
    cosine_sq: float  # of the angle limit
    force_sq: float  # difference rule (CD-4) [N²]
    acceleration_sq: float  # [m²/s⁴]
    clear_sq: float  # over the variance of the contact force: beyond, it needs no second tick (CD-9)
    clear_acceleration_sq: float  # [m²/s⁴]
    driven: float  # the arm moves its load beyond so many deviations of noise (CD-0)
    ratio: float  # ratio rule: beyond minus this (CD-5) [kg]
    ratio_acceleration_sq: float  # its second threshold [m²/s⁴]
    value_force: float  # instant rule, beside what a wrong payload explains (CD-3) [N]
    value_acceleration: float  # [m/s²]
    confidence_sq: float  # statistical rule: standard errors, squared (CD-6)
    force_variance: float  # least, of one axis, that the buffer is taken to have [N²]
    acceleration_variance: float  # [m²/s⁴]
    slow_force: float  # slow rule (CD-7) [N]
    payload_margin: float  # force that a wrong payload may explain, an acceleration difference [kg]
    clamping: float  # force difference over acceleration difference, beyond which it is clamping [kg]
    mass: float  # configured [kg]
    force_step: int = 3  # ticks between the samples of a difference of force, i (CD-4)
    acceleration_step: int = 3  # of one of acceleration, j
    tested: int = 5  # newest samples that the statistical rule tests (CD-6)
    window: int = 30  # samples before them
    newest: int = 10  # of the slow rule, p (CD-7)
    oldest: int = 20  # of its stored values, q
    median: bool = False  # stands for them, in place of the mean (CD-8)


def scale_of(use: ContactUse, mode: Mode, speed: float) -> float:
    """Factor on all thresholds (CD-11, CD-12); `speed` is that of the tool centre point [m/s]."""
    scale = (1.0 + use.speed_share * speed) / use.sensitivity
    return scale * use.free_drive_factor if mode is Mode.FREE_DRIVE else scale


def limits(
    use: ContactUse,
    mode: Mode,
    *,
    mass: float,
    effective_mass: float,
    speed: float,
    lever: float = 0.0,
    sensor: SensorSpec = USUAL,
) -> ContactLimits:
    """The thresholds of one source now.

    Args:
        use: the settings.
        mode: robot mode.
        mass: configured, that the force carries [kg].
        effective_mass: of the arm behind the part [kg].
        speed: of the tool centre point [m/s].
        lever: of the carried mass: the angular acceleration's noise counts with it [m].
        sensor: has the noise where the settings have none.
    """
    scale = scale_of(use, mode, speed)
    # Of the three axes of a turning, each point feels two.
    noise_f, straight = use.force_noise or sensor.noise_force, use.acceleration_noise or sensor.noise_acceleration
    noise_a = (straight**2 + 2.0 / 3.0 * (use.turn_noise * lever) ** 2) ** 0.5
    slow_force = use.slow_force + use.slow_payload * mass
    pair = 2.0**0.5  # standard deviation of a difference of two samples, over one sample's
    noisy = use.noise_limit * pair
    hard = use.hard_limit * pair * scale
    # The acceleration of a load off the axis comes up to a tick later than its force: in vibration they lie against each other.
    mismatch = scale * use.hard_payload * mass
    margin = use.payload_error * mass
    return ContactLimits(
        noise_force_sq=(noisy * noise_f) ** 2,
        noise_acceleration_sq=(noisy * noise_a) ** 2,
        opposite=use.opposite,
        cosine_sq=use.angle**2,
        force_sq=(hard * noise_f + mismatch) ** 2,
        acceleration_sq=(hard * noise_a) ** 2,
        clear_sq=(1.0 + 1.0 / OLDER) * (use.clear_limit * scale) ** 2,
        clear_acceleration_sq=(use.clear_acceleration * scale) ** 2,
        driven=use.noise_limit,
        ratio=scale * min(use.ratio_share * max(mass, LIGHTEST), ARM_SHARE * effective_mass),
        ratio_acceleration_sq=(use.ratio_acceleration * scale) ** 2,
        value_force=scale * use.value_force,
        value_acceleration=use.value_acceleration * scale,
        confidence_sq=(use.confidence * scale) ** 2,
        force_variance=noise_f * noise_f,
        acceleration_variance=noise_a * noise_a,
        slow_force=slow_force * scale,
        payload_margin=margin,
        clamping=use.clamping_ratio + margin,
        mass=mass,
        force_step=use.force_step,
        acceleration_step=use.acceleration_step,
        tested=use.tested,
        window=use.window,
        newest=use.newest,
        oldest=use.oldest,
        median=use.statistic is BufferStatistic.MEDIAN,
    )
