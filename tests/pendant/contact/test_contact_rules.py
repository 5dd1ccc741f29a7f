"""Each rule at its boundaries: opposite directions, thresholds, full buffers (CD-0, CD-3 to CD-8)."""

import msgspec
import numpy as np
import pytest

from pendant.contact.contact_limits import OLDER
from pendant.contact.contact_rules import LAGS, MEAN, NEW, OLD, STEP, clear, contact_force, hard, slow, statistical, values
from pendant.contact.history import History
from pendant.contact.settings import ContactUse
from pendant.tick.source_signal import Signal
from tests.pendant.contacts import USE, limit

BIAS = (1.0, 2.0, 3.0, 0.0, 0.0, 9.81)


def history(*rows: tuple[float, ...], repeat: int = 1) -> History:
    result = History()
    for row in rows:
        for _ in range(repeat):
            result.push(Signal(*row))
    return result


def stepped(df: tuple[float, float, float], da: tuple[float, float, float]) -> History:
    """A difference of df, da within the difference rule's step, on top of a bias."""
    return history(BIAS, *[changed(df, da)] * STEP)


def sudden(df: tuple[float, float, float], da: tuple[float, float, float], older: int = OLDER) -> History:
    """The same in the newest sample alone, after `older` without it."""
    return history(*[BIAS] * older, changed(df, da))


def changed(df: tuple[float, float, float], da: tuple[float, float, float]) -> tuple[float, ...]:
    return tuple(bias + change for bias, change in zip(BIAS, (*df, *da), strict=True))


@pytest.mark.parametrize(
    ("df", "da", "difference", "ratio"),
    [
        ((2.0, 0.0, 0.0), (-2.0, 0.0, 0.0), True, True),
        ((-2.0, 0.0, 0.0), (2.0, 0.0, 0.0), True, True),  # sign-symmetric: contact lost
        ((2.0, 0.0, 0.0), (2.0, 0.0, 0.0), False, False),  # parallel: free motion
        ((2.0, 0.0, 0.0), (0.0, 2.0, 0.0), False, False),  # neither
        ((0.0, 2.0, 0.0), (0.1, -2.0, 0.3), True, True),  # in 3-D
        ((1.26, 0.0, 0.0), (-0.6, 0.0, 0.0), True, False),  # 0.849 N + 0.4 N/kg, 0.566 m/s² are the limits
        ((1.24, 0.0, 0.0), (-0.6, 0.0, 0.0), False, False),  # and 1 m/s² the ratio's second
        ((1.26, 0.0, 0.0), (-0.55, 0.0, 0.0), False, False),
        ((0.7, 0.0, 0.0), (-1.1, 0.0, 0.0), False, True),  # ratio -0.64 kg
        ((0.55, 0.0, 0.0), (-1.15, 0.0, 0.0), False, False),  # ratio -0.48 kg, threshold -0.5 kg
        ((0.6, 0.0, 0.0), (-1.1, 0.0, 0.0), False, False),  # force within the noise
    ],
)
def test_difference_and_ratio(
    df: tuple[float, float, float], da: tuple[float, float, float], difference: bool, ratio: bool
) -> None:
    assert hard(stepped(df, da), limit()) == (difference, ratio)


@pytest.mark.parametrize(
    ("df", "da", "seen"),
    [  # 1 kg carried: 5 deviations of the difference of F - m·A are 0.929 N, a quarter of the payload explains 0.25 kg of dA
        ((-0.28, 0.0, 0.0), (-1.6, 0.0, 0.0), False),  # F - m·A changes by 1.32 N, threshold 1.329 N
        ((-0.26, 0.0, 0.0), (-1.6, 0.0, 0.0), True),  # though F is within the noise, and along A
        ((0.26, 0.0, 0.0), (1.6, 0.0, 0.0), True),
        ((0.8, 0.0, 0.0), (-0.69, 0.0, 0.0), False),
        ((0.8, 0.0, 0.0), (-0.71, 0.0, 0.0), True),
        ((0.0, 8.0, 0.0), (1.6, -0.1, 0.0), False),  # across
        ((3.0, 0.0, 0.0), (1.6, 0.0, 0.0), False),  # along it: free motion of a load that is too heavy
        ((0.0, 0.0, 0.0), (-3.0, 0.0, 0.0), True),  # the accelerometer feels it first
        ((0.0, 9.4, 0.0), (-3.0, 0.0, 0.0), True),  # F - m·A within the angle limit of A
        ((0.0, 9.6, 0.0), (-3.0, 0.0, 0.0), False),
    ],
)
def test_a_difference_that_is_clear(df: tuple[float, float, float], da: tuple[float, float, float], seen: bool) -> None:
    assert clear(sudden(df, da), limit()) is seen


@pytest.mark.parametrize(("driven", "seen"), [(-9.0, True), (3.0, True), (3.1, False)])
def test_where_the_arm_moves_its_load_no_rule_of_directions_sees_a_contact(driven: float, seen: bool) -> None:
    """CD-0: beyond 3 deviations of noise; whoever does not ask for opposite directions does not ask for this either."""
    df, da = (3.0, 0.0, 0.0), (-3.0, 0.0, 0.0)
    steps = {clear: (OLDER, 1), hard: (OLDER, STEP), statistical: (OLD, NEW)}
    for rule, (older, newer) in steps.items():
        now = Signal(*changed(df, da))._replace(driven=driven)
        said = rule(history(*[BIAS] * older, *[now] * newer), limit())
        assert said == ((seen, seen) if rule is hard else seen)
        assert rule(history(*[BIAS] * older, *[now] * newer), limit(msgspec.structs.replace(USE, opposite=False)))
    # It is the newer sample of a pair that tells.
    then, now = Signal(*changed(df, da))._replace(driven=driven), Signal(*changed(df, da))
    assert hard(history(BIAS, then, now, now), limit()).difference
    assert hard(history(BIAS, then, then, then, then), limit(), 1).difference is seen


def test_a_clear_difference_is_one_from_all_older_samples() -> None:
    """CD-9: from their mean; with fewer of them there is none."""
    df, da = (3.0, 0.0, 0.0), (-3.0, 0.0, 0.0)
    assert clear(sudden(df, da), limit())
    assert not clear(sudden(df, da, OLDER - 1), limit())
    # So many had changed before: 5.25 and 3 N are left of 6 N
    assert clear(history(*[BIAS] * OLDER, *[changed(df, da)] * 3), limit())
    assert not clear(history(*[BIAS] * OLDER, *[changed(df, da)] * 9), limit())


@pytest.mark.parametrize(("force", "seen"), [(-0.32, False), (-0.30, True)])
def test_a_heavy_load_makes_the_contact_force_noisy(force: float, seen: bool) -> None:
    """5 kg: 5 deviations are 5·(17/16·(0.15² + (5·0.1)²))^½ = 2.69 N, and 1.25 kg of 0.8 m/s² explain 1 N; F - m·A is F + 4 N."""
    assert clear(sudden((force, 0.0, 0.0), (-0.8, 0.0, 0.0)), limit(mass=5.0)) is seen


@pytest.mark.parametrize(
    ("turning", "seen"),
    [
        ((0.0, 0.0, 0.0), True),
        ((0.9, 0.0, 0.0), False),  # a tick and a half later it would leave -0.65 m/s² of the -2 m/s²
        ((0.8, 0.0, 0.0), True),  # -0.8 m/s²
        ((1.4, 0.0, 0.0), False),  # or turn it round
        ((-2.0, 0.0, 0.0), True),
    ],
)
def test_what_is_clear_is_so_with_a_turning_that_is_known_late(turning: tuple[float, float, float], seen: bool) -> None:
    """CD-9, CD-11: F - m·A against A, now and with A as it would be."""
    now = Signal(*changed((2.0, 0.0, 0.0), (-2.0, 0.0, 0.0)))._replace(sx=turning[0], sy=turning[1], sz=turning[2])
    assert clear(history(*[BIAS] * OLDER, now), limit()) is seen


@pytest.mark.parametrize(
    ("turning", "unrest", "seen"),
    [(0.0, 0.0, True), (0.4, 0.0, True), (0.6, 0.0, False), (0.0, 0.6, True), (0.0, 0.8, False)],
)
def test_what_is_clear_stands_out_from_the_unrest_before(turning: float, unrest: float, seen: bool) -> None:
    """1 kg, F - m·A changes by 4 N, of which 0.25 N may be the payload's.

    It takes 5·(17/16·(0.15² + 2·0.4²))^½ = 3.0 N and with 0.6 m/s² 4.4 N where the turning changes by so much from tick to tick,
    5·(17/16·(0.15² + 0.6²))^½ = 3.2 N and with 0.8 m/s² 4.2 N where the acceleration goes to and fro by so much.
    """
    ways = [unrest, -unrest] * (OLDER // 2)
    x, y, z, ax, ay, az = BIAS
    rest = [Signal(x, y, z, ax + way, ay - way, az + way, sx=turning, sy=-turning, sz=turning) for way in ways]
    assert clear(history(*rest, changed((3.0, 0.0, 0.0), (-1.0, 0.0, 0.0))), limit()) is seen


@pytest.mark.parametrize(("cosine", "opposite"), [(-0.29, False), (-0.31, True), (-0.99, True)])
def test_the_angle_limit(cosine: float, opposite: bool) -> None:
    sine = (1.0 - cosine**2) ** 0.5
    use = msgspec.structs.replace(USE, retrospective=False)
    change = hard(stepped((3.0, 0.0, 0.0), (0.9 * cosine, 0.9 * sine, 0.0)), limit(use))
    assert change.difference is opposite
    # F - m·A, A without a load
    now = history((40.0, 0.0, 0.0, 10.0 * cosine, 10.0 * sine, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert values(now, limit(mass=0.0))[0] is opposite


@pytest.mark.parametrize(("cosine", "seen"), [(-0.29, False), (-0.31, True)])
def test_the_angle_limit_of_what_is_clear(cosine: float, seen: bool) -> None:
    """Of F - m·A against A; without a load that is F."""
    sine = (1.0 - cosine**2) ** 0.5
    assert clear(sudden((3.0, 0.0, 0.0), (3.0 * cosine, 3.0 * sine, 0.0)), limit(mass=0.0)) is seen


def test_without_an_angle_limit_what_is_clear_still_lies_against_the_acceleration() -> None:
    use = msgspec.structs.replace(USE, angle=0.0)
    across = sudden((0.1, 1.5, 0.0), (1.2, 0.0, 0.0))
    assert not clear(across, limit(use, mass=0.0))
    assert clear(sudden((-0.1, 1.5, 0.0), (1.2, 0.0, 0.0)), limit(use, mass=0.0))
    assert clear(across, limit(msgspec.structs.replace(use, opposite=False), mass=0.0))


def test_without_an_angle_limit_a_value_across_is_still_none() -> None:
    """CD-0: opposite is less than across."""
    use = msgspec.structs.replace(USE, angle=0.0)
    across, against = (12.0, 12.0, 0.0, -4.0, 4.0, 0.0), (12.0, 12.0, 0.0, -4.0, 3.5, 0.0)
    assert values(history(across), limit(use, mass=0.0)) == (False, False)
    assert values(history(against), limit(use, mass=0.0)) == (True, True)


@pytest.mark.parametrize(
    ("force", "acceleration", "mass", "expected"),
    [
        ((8.0, 1.0), (-4.0, 0.0), 0.0, (False, True)),  # 8 N along the axis, more in space
        ((8.5, 1.0), (-4.0, 0.0), 0.0, (True, True)),
        ((12.0, 0.0), (-3.0, 0.0), 0.0, (False, False)),  # 3 m/s²
        ((12.0, 0.0), (-3.5, 0.0), 0.0, (True, True)),
        ((12.0, 0.0), (-8.0, 0.0), 1.0, (True, False)),  # -0.5 kg, with the payload's own 1 kg
        ((12.5, 0.0), (-8.0, 0.0), 1.0, (True, True)),
    ],
)
def test_values_at_their_thresholds_are_not_beyond_them(
    force: tuple[float, float], acceleration: tuple[float, float], mass: float, expected: tuple[bool, bool]
) -> None:
    """CD-3, CD-5: without gravity, where all of it is exact."""
    (fx, fy), (ax, ay) = force, acceleration
    now = history((fx + mass * ax, fy + mass * ay, 0.0, ax, ay, 0.0, 0.0, 0.0, 0.0, mass))
    assert values(now, limit(mass=mass)) == expected


@pytest.mark.parametrize(("side", "seen"), [(0.375, False), (0.625, True)])
def test_instant_is_along_one_axis_however_low_the_thresholds(side: float, seen: bool) -> None:
    """CD-3: 0.5 N and 0.5 m/s². Along x both are beyond, and parallel; along y the force is `side`, against 4 m/s²."""
    use = msgspec.structs.replace(USE, sensitivity=4.0, value_force=2.0, value_acceleration=2.0)
    assert values(history((0.625, side, 0.0, 0.625, -4.0, 0.0)), limit(use, mass=0.0))[0] is seen


@pytest.mark.parametrize(
    ("force", "acceleration", "seen"),
    [(10.6, -3.1, True), (10.4, -3.1, False), (10.6, -2.9, False), (10.6, 3.1, False), (-10.6, 3.1, True)],
)
def test_instant_at_its_thresholds(force: float, acceleration: float, seen: bool) -> None:
    """8 N and a quarter of the payload times about 10.25 m/s², 10.56 N; 3 m/s². The payload's m·A is subtracted, gravity too."""
    mass = 1.0
    row = (force + mass * acceleration, 0.0, mass * 9.81, acceleration, 0.0, 9.81, 0.0, 0.0, -9.81, mass)
    assert values(history(row), limit())[0] is seen


@pytest.mark.parametrize(
    ("force", "acceleration", "seen"),
    [
        ((12.0, 0.0), (-4.0, 0.0), True),  # F/a = -3 kg, the payload's own 1 kg added: -2 kg
        ((10.6, 0.0), (-4.0, 0.0), False),  # 8 N and a quarter of m·A, 10.59 m/s²: 10.65 N
        ((12.0, 0.0), (-2.9, 0.0), False),
        ((14.0, 0.0), (-9.2, 0.0), True),  # threshold: -1.5 kg together with the payload's 1 kg
        ((14.0, 0.0), (-9.5, 0.0), False),
        ((12.0, 0.0), (4.0, 0.0), False),
        ((9.0, 9.0), (-4.0, -4.0), True),  # in 3-D, where no single axis is beyond
    ],
)
def test_the_ratio_of_values(force: tuple[float, float], acceleration: tuple[float, float], seen: bool) -> None:
    (fx, fy), (ax, ay), mass = force, acceleration, 1.0
    row = (fx + mass * ax, fy + mass * ay, mass * 9.81, ax, ay, 9.81, 0.0, 0.0, -9.81, mass)
    assert values(history(row), limit())[1] is seen


def test_no_decision_from_buffers_that_are_not_full() -> None:
    before, after = (0.0, 0.0, 9.81, 0.0, 0.0, 9.81), (30.0, 0.0, 9.81, -20.0, 0.0, 9.81)
    assert hard(history(*[after] * STEP), limit()) == (False, False)
    assert values(History(), limit()) == (False, False)
    assert not statistical(history(*[before] * (OLD - 1), *[after] * NEW), limit())
    assert statistical(history(*[before] * OLD, *[after] * NEW), limit())
    assert slow(history(*[before] * (MEAN - 1), *[after] * LAGS[0]), limit()) == (0, False)
    assert slow(history(*[before] * MEAN, *[after] * LAGS[0]), limit()).sightings


def test_a_saturated_force_has_no_size() -> None:
    still, gone = (0.0, 0.0, 9.81, 0.0, 0.0, 9.81), (30.0, 0.0, 9.81, -20.0, 0.0, 9.81)
    seen = history(*[still] * LAGS[-1], *[gone] * (NEW - 1))
    seen.push(Signal(*gone, saturated=1.0))
    assert values(seen, limit()) == (False, False)
    assert not statistical(seen, limit())
    assert slow(seen, limit()) == (0, False)
    for _ in range(STEP):
        seen.push(Signal(*still))
    assert values(seen, limit(USE)) == (False, False)
    assert hard(seen, limit()).difference  # its changes are looked at
    assert seen.clean == STEP


def test_the_statistical_rule_takes_its_thresholds_from_the_buffer() -> None:
    rng = np.random.default_rng(1)

    def noisy(sigma: float) -> History:
        rows = rng.normal(0.0, 1.0, (OLD + NEW, 6)) * ([sigma] * 3 + [0.1] * 3)
        rows[-NEW:] += [1.0, 0.0, 0.0, -1.0, 0.0, 0.0]
        return history(*[tuple(row) for row in rows.tolist()])

    assert statistical(noisy(0.15), limit())
    assert not statistical(noisy(2.0), limit())


@pytest.mark.parametrize(
    ("push", "seen"),
    [  # 5 kg by 0.8 m/s²: 4 N along it; a payload wrong by a quarter explains 1 N of the force on the object
        (0.0, False),
        (-2.1, False),  # and its noise, 1.25 times the confidence interval, 1.13 N
        (-2.2, True),  # F still lies along A
        (-6.0, True),  # and against it
        (3.0, False),  # a push from behind is none against which something moves
    ],
)
def test_an_object_against_a_heavy_load_that_is_moved(push: float, seen: bool) -> None:
    """CD-0, CD-6: the payload's own m·A hides which way the object pushes; the contact force shows it."""
    still, now = (0.0, 0.0, 49.05, 0.0, 0.0, 9.81), (4.0 + push, 0.0, 49.05, 0.8, 0.0, 9.81)
    assert statistical(history(*[still] * OLD, *[now] * NEW), limit(mass=5.0)) is seen


@pytest.mark.parametrize(
    ("df", "da", "expected"),
    [
        (0.55, -0.4, (1, False)),  # against a payload of 1 kg: 0.95 N beyond it, opposite
        (0.3, -0.4, (0, False)),  # 0.7 N: within the 0.8 N and 0.1 N that a payload wrong by a quarter explains
        (1.5, 0.0, (1, True)),  # the acceleration has died out
        (1.7, 0.0, (2, True)),  # twice the 0.8 N: two sightings
        (9.0, 0.0, (5, True)),  # at most five
        (0.75, 0.0, (0, False)),
        (0.4, 0.4, (0, False)),  # the payload alone
        (3.0, 0.9, (0, False)),  # parallel, and not died out
    ],
)
def test_the_slow_rule(df: float, da: float, expected: tuple[int, bool]) -> None:
    seen = history(*[(5.0, 0.0, 0.0, 1.0, 0.0, 9.81)] * MEAN, *[(5.0 + df, 0.0, 0.0, 1.0 + da, 0.0, 9.81)] * LAGS[0])
    assert slow(seen, limit()) == expected


def test_a_flat_change_shows_against_an_older_mean() -> None:
    rows = [(0.008 * k, 0.0, 0.0, 0.0, 0.0, 9.81) for k in range(LAGS[-1] + MEAN)]
    assert slow(history(*rows), limit()) == (2, True)
    assert slow(history(*rows[:100]), limit()) == (0, False)


def test_contact_force_leaves_out_the_payload() -> None:
    assert contact_force((5.0, 2.0, 12.0, 1.0, -0.5, 4.0), 2.0) == (3.0, 3.0, 4.0)


def test_the_settings_ship_with_detection_off() -> None:
    assert not ContactUse().on


def test_the_rules_on_values_in_space() -> None:
    """CD-3, CD-5, eq. 8, with vectors: the force without the payload's, against the acceleration without gravity."""
    rng, said = np.random.default_rng(4), set()
    for _ in range(3000):
        mass, thresholds = float(rng.choice([0.0, 1.0, 3.0])), limit(mass=1.0)
        a = rng.normal(0.0, 4.0, 3)
        push = -a * rng.uniform(0.0, 5.0) + rng.normal(0.0, rng.choice([1.0, 6.0]), 3)
        g = 9.81 * np.array(rng.choice([[0.0, 0.0, -1.0], [0.6, 0.0, 0.8], [0.0, -0.8, 0.6]]))
        felt = a - g
        now = history((*(mass * felt + push).tolist(), *felt.tolist(), *g.tolist(), mass, 2.0))
        force = thresholds.value_force + thresholds.payload_margin * float(np.linalg.norm(felt))
        against, size = float(push @ a), float(np.linalg.norm(push))
        opposite = against < 0.0 and against**2 >= thresholds.cosine_sq * size**2 * float(a @ a) and size >= force
        beyond = (push * a < 0.0) & (abs(push) > force) & (abs(a) > thresholds.value_acceleration)
        ratio = float((push + mass * a) @ a) / float(a @ a)
        fast = float(np.linalg.norm(a)) > thresholds.value_acceleration
        expected = (opposite and bool(beyond.any()), opposite and fast and abs(ratio) > thresholds.ratio)
        assert values(now, thresholds) == expected
        said.add(expected)
    assert said == {(False, False), (True, False), (False, True), (True, True)}
