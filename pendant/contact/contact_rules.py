"""The rules that see a change in contact in a history of force and acceleration (CD-0, CD-3 to CD-8). Pure functions.

Every rule but clamping asks for opposite directions: in free motion the carried load makes the changes of force and
acceleration parallel, whatever its mass; a contact of the carried part makes them opposite (docs/explanation/contact.md). A
saturated force has no size; its changes alone are looked at.
"""

from typing import NamedTuple

from pendant.contact.contact_limits import OLDER, ContactLimits
from pendant.contact.history import History, Six
from pendant.tick.pose import Vector
from pendant.tick.source_signal import Signal
from pendant.tick.words import Word

STEP = 3
"""Ticks between the two samples of a difference, as shipped (CD-4)."""
LATE = 1.5
"""Ticks by which what a load's turning adds to its acceleration is late at most: half a tick, for it is the difference of two
mean angular speeds, a third for its filter, and the rest of the tick where it begins suddenly."""
RESTLESS = 2.0
"""Share of the variance of its changes from tick to tick that counts as variance of the acceleration."""
HEAVIEST = 5
"""Sightings that one of the slow rule counts for at most."""
NEW = 5
"""Newest samples under test in the statistical rule, as shipped (CD-6)."""
OLD = 30
"""Samples before them, whose mean and variance they are held against, as shipped."""
P = 10
"""Samples of the slow rule's newest mean, as shipped (CD-7)."""
MEAN = 20
"""Samples of the stored means that it is held against, as shipped."""
LAGS = (20, 60, 200)
"""Ages of the stored means that the newest is held against (CD-8): steep changes show early, flat ones in the long run."""
OBJECT = 1.25
"""The statistical rule's limit of the force on the object, over the confidence interval: a wrong payload has no noise."""
DIED_OUT = 0.25
"""Change of the acceleration that is none any more [m/s²]: with a larger one a contact has been gained, and is no clamping."""


class Rule(Word):
    """Which rule saw it (CD-10)."""

    INSTANT = "instant"
    DIFFERENCE = "difference"
    RATIO = "ratio"
    STATISTICAL = "statistical"
    SLOW = "slow"


class Hard(NamedTuple):
    """What the change of the last `STEP` ticks shows."""

    difference: bool  # difference rule
    ratio: bool  # ratio rule


NOTHING = Hard(False, False)


def hard(history: History, limit: ContactLimits, age: int = 0) -> Hard:
    """Difference rule (CD-4, eq. 5, 6) and ratio rule (CD-5, eq. 7) on a pair of samples, the newer one `age` ticks old."""
    i, j = limit.force_step, limit.acceleration_step
    if history.count <= max(i, j) + age:
        return NOTHING
    new, old = history.sample(age), history.sample(age + i)
    if _arm_moves_load(new, limit):
        return NOTHING
    fx, fy, fz = new[0] - old[0], new[1] - old[1], new[2] - old[2]
    if i != j:
        old = history.sample(age + j)
    ax, ay, az = new[3] - old[3], new[4] - old[4], new[5] - old[5]
    aa = ax * ax + ay * ay + az * az
    if aa < limit.noise_acceleration_sq:
        return NOTHING
    dot = fx * ax + fy * ay + fz * az
    ff = fx * fx + fy * fy + fz * fz
    if (dot >= 0.0 and limit.opposite) or ff < limit.noise_force_sq or dot * dot < limit.cosine_sq * ff * aa:
        return NOTHING
    difference = ff > limit.force_sq and aa > limit.acceleration_sq
    return Hard(difference, aa > limit.ratio_acceleration_sq and abs(dot) > limit.ratio * aa)


def _arm_moves_load(sample: Signal, limit: ContactLimits) -> bool:
    """The arm moves its load, as a push on a link lets it: no contact of the load does (`sim.estimation.flange_drive`)."""
    return sample.driven > limit.driven and limit.opposite


def clear(history: History, limit: ContactLimits) -> bool:
    """A difference so clear that the newest sample tells it by itself, held against all of the `OLDER` before it (CD-9).

    It is one of the contact force, F - m·A, far beyond its noise and what a wrong payload explains, against an acceleration
    that free motion never changes so much in the opposite direction. The force itself may still lie along the acceleration: a
    hard contact is felt by the accelerometer before it has come to the force's sensor.

    What the load's turning adds to the acceleration is known late, and an arm that vibrates would lay force and acceleration
    against each other by that. So the acceleration counts as uncertain as it was restless before, and the difference has to be
    as clear with what the turning would add `LATE` ticks later, if it went on changing.
    """
    if history.count <= OLDER:
        return False
    new, old = history.sample(0), history.mean(1, OLDER)
    f = (new[0] - old[0], new[1] - old[1], new[2] - old[2])
    a = (new[3] - old[3], new[4] - old[4], new[5] - old[5])
    if _arm_moves_load(new, limit):
        return False
    if not _lies_against(f, a, 0.0, limit):  # most often; how restless it was takes a look at all samples
        return False
    restless = max(limit.acceleration_variance, history.variances(1, OLDER, old)[1], RESTLESS * _turning(history))
    least = (limit.clear_sq * (limit.force_variance + limit.mass * limit.mass * restless)) ** 0.5
    late = (a[0] + LATE * new.sx, a[1] + LATE * new.sy, a[2] + LATE * new.sz)
    return _lies_against(f, a, least, limit) and _lies_against(f, late, least, limit)


def _turning(history: History) -> float:
    """Mean square, of one axis, of the changes of what the turning adds, before the newest sample [m²/s⁴]."""
    before = (history.sample(age) for age in range(1, OLDER + 1))
    return sum(s.sx * s.sx + s.sy * s.sy + s.sz * s.sz for s in before) / (3.0 * OLDER)


def _lies_against(f: Vector, a: Vector, least: float, limit: ContactLimits) -> bool:
    """`_clear` of a change of the force and one of the acceleration that is large enough."""
    aa = a[0] * a[0] + a[1] * a[1] + a[2] * a[2]
    ff, dot = f[0] * f[0] + f[1] * f[1] + f[2] * f[2], f[0] * a[0] + f[1] * a[1] + f[2] * a[2]
    return aa > limit.clear_acceleration_sq and _clear(limit, least, ff=ff, aa=aa, dot=dot)


def _clear(limit: ContactLimits, least: float, *, ff: float, aa: float, dot: float) -> bool:
    """The change of the contact force, F - m·A, lies against A and is beyond `least` [N] and what a wrong payload explains.

    `ff`, `aa` and `dot` are the inner products F·F, A·A and F·A of the two changes.
    """
    mass = limit.mass
    against = dot - mass * aa  # F - m·A along A
    if against >= 0.0 and limit.opposite:
        return False
    square = ff - 2.0 * mass * dot + mass * mass * aa
    size = least + limit.payload_margin * aa**0.5
    return square > size * size and against * against > limit.cosine_sq * square * aa


def values(history: History, limit: ContactLimits) -> tuple[bool, bool]:
    """What the values of now show: the instant rule (CD-3) and the ratio rule on values (CD-5, eq. 8).

    The configured payload's m·A is subtracted from the force, gravity from the acceleration; what a wrong payload explains of
    the force is none. Instant: along one axis a force
    beyond its threshold against an acceleration beyond its own. Ratio: of such a force, the payload's m·a added again, and the
    acceleration.
    """
    if history.clean == 0:
        return False, False
    fx, fy, fz, ax, ay, az, gx, gy, gz, mass = history.sample(0)[:10]
    fx, fy, fz = fx - mass * ax, fy - mass * ay, fz - mass * az
    specific = (ax * ax + ay * ay + az * az) ** 0.5
    ax, ay, az = ax + gx, ay + gy, az + gz
    dot = fx * ax + fy * ay + fz * az
    if dot >= 0.0 and limit.opposite:
        return False, False
    force, acceleration = limit.value_force + limit.payload_margin * specific, limit.value_acceleration
    ff, aa = fx * fx + fy * fy + fz * fz, ax * ax + ay * ay + az * az
    if ff < force * force or dot * dot < limit.cosine_sq * ff * aa:
        return False, False
    axes = ((fx, ax), (fy, ay), (fz, az))
    instant = any(f * a < 0.0 and abs(f) > force and abs(a) > acceleration for f, a in axes)
    return instant, aa > acceleration * acceleration and abs(dot + mass * aa) > limit.ratio * aa


def statistical(history: History, limit: ContactLimits) -> bool:
    """The newest samples against mean and confidence interval of those before them (CD-6, eq. 9, 10).

    While an arm that is moved carries a heavy load, that load's m·A hides which way an object pushes; then the contact force,
    F - m·A, shows it (CD-0).
    """
    tested, window = limit.tested, limit.window
    if history.clean < tested + window or _arm_moves_load(history.sample(0), limit):
        return False
    nfx, nfy, nfz, nax, nay, naz = history.mean(0, tested)
    old = history.mean(tested, window)
    ofx, ofy, ofz, oax, oay, oaz = old
    ax, ay, az = nax - oax, nay - oay, naz - oaz
    aa = ax * ax + ay * ay + az * az
    error = limit.confidence_sq * (1.0 / tested + 1.0 / window)
    if aa <= error * limit.acceleration_variance:
        return False
    force, acceleration = history.variances(tested, window, old)
    force, acceleration = max(force, limit.force_variance), max(acceleration, limit.acceleration_variance)
    if aa <= error * acceleration:
        return False
    fx, fy, fz = nfx - ofx, nfy - ofy, nfz - ofz
    dot = fx * ax + fy * ay + fz * az
    ff = fx * fx + fy * fy + fz * fz
    if (dot < 0.0 or not limit.opposite) and dot * dot >= limit.cosine_sq * ff * aa and ff > error * force:
        return True
    mass = limit.mass
    return _clear(limit, OBJECT * (error * (force + mass * mass * acceleration)) ** 0.5, ff=ff, aa=aa, dot=dot)


class Slow(NamedTuple):
    """What the slow rule sees."""

    sightings: int  # that it counts for: as many as its force is times the threshold, 0 for none
    dead: bool  # the acceleration has died out: clamping


UNSEEN = Slow(0, False)


def slow(history: History, limit: ContactLimits) -> Slow:
    """The newest mean, or median, against stored ones (CD-7, CD-8, eq. 11 to 17)."""
    count, oldest = history.clean, limit.oldest
    if count < LAGS[0] + oldest:
        return UNSEEN
    of = history.median if limit.median else history.mean
    new = of(0, limit.newest)
    mass, threshold = limit.mass, limit.slow_force
    for lag in LAGS:
        if count < lag + oldest:
            break
        old = of(lag, oldest)
        dfx, dfy, dfz = new[0] - old[0], new[1] - old[1], new[2] - old[2]
        ax, ay, az = new[3] - old[3], new[4] - old[4], new[5] - old[5]
        fx, fy, fz = dfx - mass * ax, dfy - mass * ay, dfz - mass * az
        ff = fx * fx + fy * fy + fz * fz
        if ff < threshold * threshold:
            continue
        size, change = ff**0.5, (ax * ax + ay * ay + az * az) ** 0.5
        sightings = min(int(size / threshold), HEAVIEST)
        if size > limit.clamping * change:
            return Slow(sightings, change < DIED_OUT)
        if size < threshold + limit.payload_margin * change:
            continue
        dot = dfx * ax + dfy * ay + dfz * az
        least = limit.cosine_sq * (dfx * dfx + dfy * dfy + dfz * dfz) * change * change
        if (dot < 0.0 or not limit.opposite) and dot * dot > least:
            return Slow(sightings, False)
    return UNSEEN


def contact_force(sample: Six, mass: float) -> tuple[float, float, float]:
    """Force on the object [N]: what the configured payload does not explain (CD-13). `sample`: force, then acceleration."""
    return sample[0] - mass * sample[3], sample[1] - mass * sample[4], sample[2] - mass * sample[5]
