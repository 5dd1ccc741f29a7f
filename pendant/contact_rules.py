"""The rules that see a change in contact in a history of force and acceleration (CD-0, CD-3 to CD-8). Pure functions.

Every rule but clamping asks for opposite directions: in free motion the carried load makes the changes of force and
acceleration parallel, whatever its mass; a contact of the carried part makes them opposite (spec/contact.md, "Sign").
"""

from pendant.contact_limits import ContactLimits
from pendant.history import History, Six
from pendant.word import Word

STEP = 3
"""Ticks between the two samples of a difference (CD-4)."""
NEW = 8
"""Newest samples under test in the statistical rule (CD-6)."""
OLD = 30
"""Samples before them, whose mean and variance they are held against."""
P = 10
"""Samples of the slow rule's newest mean (CD-7)."""
MEAN = 20
"""Samples of the stored means that it is held against, q."""
LAGS = (20, 60, 200)
"""Ages of the stored means that the newest is held against (CD-8): steep changes show early, flat ones in the long run."""


class Rule(Word):
    """Which rule saw it (CD-10)."""

    INSTANT = "instant"
    DIFFERENCE = "difference"
    RATIO = "ratio"
    STATISTICAL = "statistical"
    SLOW = "slow"


def hard(history: History, limit: ContactLimits) -> tuple[bool, bool]:
    """Difference rule (CD-4) and ratio rule (CD-5, eq. 7) on the change of the last `STEP` ticks."""
    if history.count <= STEP:
        return False, False
    new, old = history.sample(0), history.sample(STEP)
    fx, fy, fz = new[0] - old[0], new[1] - old[1], new[2] - old[2]
    ax, ay, az = new[3] - old[3], new[4] - old[4], new[5] - old[5]
    dot = fx * ax + fy * ay + fz * az
    if dot >= 0.0 and limit.opposite:
        return False, False
    ff = fx * fx + fy * fy + fz * fz
    aa = ax * ax + ay * ay + az * az
    if ff < limit.noise_force_sq or aa < limit.noise_acceleration_sq or dot * dot < limit.cosine_sq * ff * aa:
        return False, False
    difference = ff > limit.force_sq and aa > limit.acceleration_sq
    return difference, aa > limit.ratio_acceleration_sq and abs(dot) > limit.ratio * aa


def instant(history: History, limit: ContactLimits) -> bool:
    """Values of now: along one axis a force beyond its threshold against an acceleration beyond its own (CD-3).

    The configured payload's m·A is subtracted from the force, gravity from the acceleration.
    """
    if history.count == 0:
        return False
    fx, fy, fz, ax, ay, az, gx, gy, gz, mass, _ = history.sample(0)
    fx, fy, fz = fx - mass * ax, fy - mass * ay, fz - mass * az
    ax, ay, az = ax + gx, ay + gy, az + gz
    dot = fx * ax + fy * ay + fz * az
    if dot >= 0.0 and limit.opposite:
        return False
    ff, aa = fx * fx + fy * fy + fz * fz, ax * ax + ay * ay + az * az
    if dot * dot < limit.cosine_sq * ff * aa:
        return False
    force, acceleration = limit.value_force, limit.value_acceleration
    axes = ((fx, ax), (fy, ay), (fz, az))
    return any(f * a < 0.0 and abs(f) > force and abs(a) > acceleration for f, a in axes)


def statistical(history: History, limit: ContactLimits) -> bool:
    """The newest `NEW` samples against mean and confidence interval of the `OLD` before them (CD-6, eq. 9, 10)."""
    if history.count < NEW + OLD:
        return False
    nfx, nfy, nfz, nax, nay, naz = history.mean(0, NEW)
    old = history.mean(NEW, OLD)
    ofx, ofy, ofz, oax, oay, oaz = old
    fx, fy, fz = nfx - ofx, nfy - ofy, nfz - ofz
    ax, ay, az = nax - oax, nay - oay, naz - oaz
    dot = fx * ax + fy * ay + fz * az
    if dot >= 0.0 and limit.opposite:
        return False
    ff, aa = fx * fx + fy * fy + fz * fz, ax * ax + ay * ay + az * az
    if dot * dot < limit.cosine_sq * ff * aa:
        return False
    force, acceleration = history.variances(NEW, OLD, old)
    error = limit.confidence_sq * (1.0 / NEW + 1.0 / OLD)
    return ff > error * max(force, limit.force_variance) and aa > error * max(acceleration, limit.acceleration_variance)


def slow(history: History, limit: ContactLimits) -> tuple[int, bool]:
    """The newest mean against stored means (CD-7, CD-8, eq. 11 to 17).

    Returns:
        The age of the stored mean that differs, 0 for none; and whether the acceleration has died out: clamping.
    """
    count = history.count
    if count < LAGS[0] + MEAN:
        return 0, False
    new = history.mean(0, P)
    mass, threshold = limit.mass, limit.slow_force
    for lag in LAGS:
        if count < lag + MEAN:
            break
        old = history.mean(lag, MEAN)
        dfx, dfy, dfz = new[0] - old[0], new[1] - old[1], new[2] - old[2]
        ax, ay, az = new[3] - old[3], new[4] - old[4], new[5] - old[5]
        fx, fy, fz = dfx - mass * ax, dfy - mass * ay, dfz - mass * az
        ff = fx * fx + fy * fy + fz * fz
        if ff < threshold * threshold:
            continue
        size, change = ff**0.5, (ax * ax + ay * ay + az * az) ** 0.5
        if size > limit.clamping * change:
            return lag, True
        if size < threshold + limit.payload_margin * change:
            continue
        dot = dfx * ax + dfy * ay + dfz * az
        least = limit.cosine_sq * (dfx * dfx + dfy * dfy + dfz * dfz) * change * change
        if (dot < 0.0 or not limit.opposite) and dot * dot > least:
            return lag, False
    return 0, False


def contact_force(sample: Six, mass: float) -> tuple[float, float, float]:
    """Force on the object [N]: what the configured payload does not explain (CD-13). `sample`: force, then acceleration."""
    return sample[0] - mass * sample[3], sample[1] - mass * sample[4], sample[2] - mass * sample[5]
