"""Contacts of links by the torques of six joints: onset, which link, release, silence (CD-2, CD-9a)."""

import msgspec
import numpy as np
import pytest

from pendant.contact.confirmation import Confirmation
from pendant.contact.contact_change import Change
from pendant.contact.history import SIZE
from pendant.contact.joint_torques import Torques
from pendant.contact.link_contact import CALM, FADED, GONE, HELD, LINKS, NEWEST, SETTLED, SILENCE, LinkChange, LinkWatch
from pendant.contact.settings import ContactUse
from pendant.tick.source_signal import ContactSignals, Signal
from tests.pendant.contacts import on_links

USE = ContactUse()
DOUBT = np.array([1.0, 1.0, 1.0, 0.2, 0.2, 0.2])
LOAD = np.array([5.0, 60.0, 30.0, 2.0, 1.0, 0.0])
"""What the gears bear [N·m]."""
SHOULDER = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
MISFIT = 0.1  # of their stiffness
LEVER, ZERO = 0.5, 3.0  # of the flange sensor's zero, and by how much that may be wrong [m], [N]
START = 100


def tick(
    torques: np.ndarray,
    *,
    borne: np.ndarray = LOAD,
    lever: float = LEVER,
    shares: tuple[float, float] = (0.0, 0.0),
    saturated: float = 0.0,
    held: np.ndarray | None = None,
) -> ContactSignals:
    """Torques on the joints; the force at both points is a tenth of their sum along x, in the other direction.

    Two causes of error: what the gears bear, and a lever of the flange sensor's zero, with the `shares` that are known.
    """
    force = -0.1 * float(torques.sum())
    link = Signal(force, 0.0, 0.0, -0.01 * force, 0.0, 9.81, saturated=saturated)
    causes = np.stack([borne, np.full(6, lever)], axis=1)
    return on_links(link, torques, DOUBT, (causes, np.tile(shares, (6, 1)), np.tile([MISFIT, ZERO], (6, 1))), held)


def stream(n: int, way: tuple[float, ...], *spans: tuple[int, int, float], noise: float = 0.1, seed: int = 0) -> np.ndarray:
    """n ticks of torques: `way` times the size of each span (begin, end, size), on noise and what the arm always feels."""
    rng = np.random.default_rng(seed)
    torques = np.tile([0.5, -1.0, 0.4, 0.1, 0.1, 0.0], (n, 1)) + rng.normal(0.0, noise, (n, 6)) * DOUBT
    for begin, end, size in spans:
        torques[begin:end] += size * np.array(way)
    return torques


def run(torques: np.ndarray, use: ContactUse = USE, scale: float = 1.0) -> list[tuple[int, LinkChange]]:
    watch, found = LinkWatch(), []
    for k, row in enumerate(torques):
        signals = tick(row)
        watch.sense(signals)
        felt = watch.step(use, signals, scale)
        if felt is not None:
            found.append((k, felt))
    return found


UPPER, FORE, HAND = (0.3, 1.0, 0.0, 0.0, 0.0, 0.0), (0.3, 1.0, 0.8, 0.0, 0.0, 0.0), (0.3, 1.0, 0.8, 0.3, 0.0, 0.0)


@pytest.mark.parametrize(("way", "part"), [(UPPER, "elbow"), ((1.0, 0, 0, 0, 0, 0), "elbow"), (FORE, "forearm"), (HAND, "wrist")])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_last_joint_that_feels_it_tells_the_link(way: tuple[float, ...], part: str, sign: float) -> None:
    found = run(stream(500, way, (START, 300, sign * 25.0)))
    assert [(felt.change, LINKS[felt.link]) for _, felt in found] == [(Change.GAINED, part), (Change.LOST, part)]
    assert START < found[0][0] < START + 25
    assert 300 < found[1][0] < 300 + HELD + GONE


def test_what_is_little_beside_the_rest_is_an_error_of_the_model() -> None:
    """The elbow joint feels 7 N·m, beyond its bound of 6, where the shoulder feels 120."""
    way = (0.0, 1.0, 7.0 / 120.0, 0.0, 0.0, 0.0)
    assert [LINKS[felt.link] for _, felt in run(stream(400, way, (START, 400, 120.0)))] == ["elbow"]
    way = (0.0, 1.0, 15.0 / 120.0, 0.0, 0.0, 0.0)
    assert [LINKS[felt.link] for _, felt in run(stream(400, way, (START, 400, 120.0)))] == ["forearm"]


@pytest.mark.parametrize(("size", "scale", "seen"), [(5.6, 1.0, False), (6.5, 1.0, True), (6.5, 2.0, False), (13.0, 2.0, True)])
def test_the_bound_is_so_many_deviations(size: float, scale: float, seen: bool) -> None:
    found = run(stream(500, (0.0, 1.0, 0.0, 0.0, 0.0, 0.0), (START, 500, size), noise=0.01), scale=scale)
    assert bool(found) is seen


def test_the_change_is_told_as_force_and_acceleration_of_the_link() -> None:
    (at, felt), _ = run(stream(500, UPPER, (START, 300, 30.0), noise=0.0))
    assert felt.force[0] == pytest.approx(-0.1 * 1.3 * 30.0, rel=0.05)
    assert felt.acceleration[0] == pytest.approx(-0.01 * felt.force[0])
    assert abs(at - felt.steps - START) <= 1


def test_a_push_that_changes_is_one_contact() -> None:
    """It swells, weakens to a third and swells again."""
    found = run(stream(900, UPPER, (100, 300, 40.0), (300, 500, 100.0), (500, 600, 35.0), (600, 700, 90.0)))
    assert [felt.change for _, felt in found] == [Change.GAINED, Change.LOST]
    assert found[1][0] > 700


def test_after_a_release_it_is_silent_until_the_torques_are_calm() -> None:
    """An arm that swings back feels 30 N·m to and fro for 0.3 s; a hand that comes afterwards is a contact again."""
    torques = stream(900, UPPER, (START, 300, 60.0), (700, 900, 30.0))
    torques[300:450, 1] += 30.0 * np.cos(np.arange(150) * 2 * np.pi / 30.0) * np.linspace(1.0, 0.0, 150)
    found = run(torques)
    assert [felt.change for _, felt in found] == [Change.GAINED, Change.LOST, Change.GAINED]
    assert found[2][0] > 700


def test_where_torques_never_calm_down_it_listens_again() -> None:
    torques = stream(SILENCE + 900, UPPER, (START, 300, 60.0))
    swing = np.arange(300, len(torques))
    torques[300:, 1] += 20.0 * np.sign(np.sin(swing * 2 * np.pi / 60.0)) * (swing > 350)
    found = run(torques)
    assert [felt.change for _, felt in found[:2]] == [Change.GAINED, Change.LOST]
    assert found[2][0] >= found[1][0] + SILENCE


def test_a_gap_ends_what_is_known_and_is_no_contact() -> None:
    torques, watch = stream(500, UPPER, (START, 500, 30.0)), LinkWatch()
    changes = []
    for k, row in enumerate(torques):
        signals = tick(row)
        if k == 200:
            watch.gap()
        watch.sense(signals)
        felt = watch.step(USE, signals, 1.0)
        changes += [] if felt is None else [felt.change]
    assert changes == [Change.GAINED]
    assert watch.touched is None
    assert watch.torques.count == 300
    watch.sense(ContactSignals())
    assert watch.torques.count == 0
    watch.sense(ContactSignals())
    assert watch.points[0].count == 0


def test_what_is_told_of_a_contact_holds_all_ticks_since_a_gap_and_none_before() -> None:
    watch, counts = LinkWatch(), []
    for k, row in enumerate(stream(400, UPPER, (300, 400, 30.0))):
        if k == 200:
            watch.gap()
        watch.sense(tick(row))
        if watch.step(USE, tick(row), 1.0) is not None:
            counts.append((watch.points[0].count, watch.points[1].count, k - 199))
    assert len(counts) == 1
    assert len(set(counts[0])) == 1


def test_ticks_with_the_sensor_at_the_end_of_its_range_are_left_out() -> None:
    """A hand comes so suddenly that the swinging load saturates the sensor for 5 ticks; the contact is found all the same."""
    torques, watch = stream(300, UPPER, (START, 300, 30.0)), LinkWatch()
    changes = []
    for k, row in enumerate(torques):
        signals = tick(row + 900.0 if START <= k < START + 5 else row, saturated=float(START <= k < START + 5))
        watch.sense(signals)
        felt = watch.step(USE, signals, 1.0)
        changes += [] if felt is None else [felt.change]
    assert changes == [Change.GAINED]
    assert watch.torques.count == 295


def test_who_forgets_is_free_of_contact_and_keeps_the_buffers() -> None:
    watch = LinkWatch()
    for row in stream(200, UPPER, (START, 200, 30.0)):
        watch.sense(tick(row))
        watch.step(USE, tick(row), 1.0)
    assert watch.touched == 0
    watch.forget()
    watch.forget()
    assert watch.touched is None
    assert not watch.silent
    assert watch.torques.count == 200


def test_confirmation_takes_the_ticks_that_are_set() -> None:
    way = (0.0, 1.0, 0.0, 0.0, 0.0, 0.0)
    slow = msgspec.structs.replace(USE, slow_count=40)
    torques = stream(300, way, (START, 300, 9.0), noise=0.01)
    assert run(torques, slow)[0][0] == run(torques)[0][0] + 20


def test_means_of_torques() -> None:
    torques = Torques()
    rows = np.random.default_rng(1).normal(size=(SIZE + 40, 6))
    for row in rows:
        torques.push(row)
    assert torques.count == SIZE - 1
    assert torques.mean(0, 10) == pytest.approx(rows[-10:].mean(axis=0))
    assert torques.mean(200, 20) == pytest.approx(rows[-220:-200].mean(axis=0))
    torques.gap()
    torques.push(rows[0])
    assert torques.mean(0, 1) == pytest.approx(rows[0])
    torques.push(np.ones(7))
    assert torques.count == 1
    assert torques.mean(0, 1) == pytest.approx(np.ones(7))


def test_silence_is_as_long_as_calm_needs_it() -> None:
    watch = LinkWatch()
    torques = stream(600, UPPER, (START, 300, 60.0))
    silent = []
    for k, row in enumerate(torques):
        watch.sense(tick(row))
        watch.step(USE, tick(row), 1.0)
        silent += [k] if watch.silent else []
    assert CALM <= len(silent) <= CALM + SETTLED + NEWEST
    assert isinstance(watch._count, Confirmation)


def test_a_contact_that_began_too_gently_is_lost_where_it_ends() -> None:
    """It swells over a second, by less than a bound within 0.2 s, and goes at once."""
    torques = stream(1000, UPPER)
    torques[100:700] += np.linspace(0.0, 20.0, 600)[:, None] * np.array(UPPER)
    assert [felt.change for _, felt in run(torques)] == [Change.LOST]


def fading(n: int, size: float, begin: int, zero: int, end: int) -> np.ndarray:
    """A hand that comes at `START` and pushes on an arm that moves: from `begin` on its lever shrinks, through zero at `zero`."""
    ticks = np.arange(n)
    share = np.interp(ticks, [START, START + 5, begin, zero, 2 * zero - begin], [0.0, 1.0, 1.0, 0.0, -1.0])
    return stream(n, UPPER) + np.where(ticks < end, size * share, 0.0)[:, None] * np.array(UPPER)


def test_a_hand_whose_lever_goes_through_zero_is_one_contact() -> None:
    """Its torques go to zero within 0.2 s and come back the other way; it is lost as the hand lets go."""
    found = run(fading(1000, 40.0, 250, 350, 440))
    assert [felt.change for _, felt in found] == [Change.GAINED, Change.LOST]
    assert 440 < found[1][0] < 440 + HELD + GONE


def test_a_hand_whose_lever_stays_at_zero_is_lost_later() -> None:
    """Whether it has gone is not known. Torques of less than two bounds that stray meanwhile are no hand that is back."""
    torques = fading(1000, 40.0, 250, 350, 360)
    torques[450:, 1] += 9.0  # of bounds of 6
    found = run(torques)
    assert [felt.change for _, felt in found] == [Change.GAINED, Change.LOST]
    assert 300 + FADED < found[1][0] < 360 + FADED + HELD


@pytest.mark.parametrize(("size", "latest"), [(14.0, HELD + GONE), (8.0, HELD + FADED)])
def test_what_was_felt_clearly_is_lost_at_once(size: float, latest: int) -> None:
    """14 N·m are 2.3 bounds, and 8 N·m 1.3: what of so little goes may be a swing."""
    (_, gained), (at, lost) = run(stream(900, UPPER, (START, 300, size), noise=0.01))
    assert (gained.change, lost.change) == (Change.GAINED, Change.LOST)
    assert 300 + latest - GONE - 25 < at < 300 + latest


def test_a_hand_that_is_taken_away_slowly_is_lost_later() -> None:
    """Over 0.3 s: the torques of a lever that shrinks are the same."""
    torques = stream(1200, UPPER, (START, 300, 30.0))
    torques[300:450] += np.linspace(30.0, 0.0, 150)[:, None] * np.array(UPPER)
    (_, gained), (at, lost) = run(torques)
    assert (gained.change, lost.change) == (Change.GAINED, Change.LOST)
    assert 400 + FADED < at < 450 + FADED + HELD


def known(*, shares: tuple[float, float], size: float, borne: float, lever: float) -> list[LinkChange]:
    """From `START` on the shoulder's gear bears so much more, the lever is longer, and the shoulder feels `size` N·m."""
    watch, found = LinkWatch(), []
    for k, row in enumerate(stream(300, (0.0, 1.0, 0.0, 0.0, 0.0, 0.0), (START, 300, size), noise=0.01)):
        later = float(k >= START)
        signals = tick(row, borne=LOAD + later * borne * SHOULDER, lever=LEVER + later * lever, shares=shares)
        watch.sense(signals)
        felt = watch.step(USE, signals, 1.0)
        found += [] if felt is None else [felt]
    return found


@pytest.mark.parametrize(("size", "seen"), [(9.8, False), (10.7, True)])
def test_shares_that_are_known_little_widen_the_bound_by_their_causes_change(size: float, seen: bool) -> None:
    """6 N·m of all else; 0.1 of 30 N·m and 3 N on 0.9 m, together the root of the squares: 4.04 N·m. At rest nothing is added."""
    assert bool(known(shares=(0.0, 0.0), size=size, borne=30.0, lever=0.9)) is seen
    assert known(shares=(0.0, 0.0), size=6.2, borne=0.0, lever=0.0)


def test_what_known_shares_explain_is_no_contact() -> None:
    """A gear that is 0.2 stiffer and bears 60 N·m more makes 12, and a zero of 4 N on 2 m makes 8: all that is felt."""
    assert not known(shares=(0.2, 4.0), size=20.0, borne=60.0, lever=2.0)
    assert known(shares=(0.0, 0.0), size=20.0, borne=60.0, lever=2.0)


def test_a_release_that_errors_may_hide_is_a_release() -> None:
    """What is left of 30 N·m is 9, of a bound of 6; by 0.1 of a gear's 50 it may all be an error."""
    watch, found = LinkWatch(), []
    torques = stream(700, UPPER, (START, 300, 30.0), (300, 700, 9.0), noise=0.01)
    for k, row in enumerate(torques):
        signals = tick(row, borne=LOAD + 50.0 * float(k > 200) * SHOULDER)
        watch.sense(signals)
        felt = watch.step(USE, signals, 1.0)
        found += [] if felt is None else [(k, felt.change)]
    assert [change for _, change in found] == [Change.GAINED, Change.LOST]
    assert 300 < found[1][0] < 300 + HELD + GONE


HELD_BACK = np.array([0.0, 8.0, 8.0, 0.0, 0.0, 0.0])
"""What friction may hold of joints whose torque comes from the motor, while the arm stands [N·m]."""


def stood(torques: np.ndarray, held: list[np.ndarray]) -> list[tuple[int, LinkChange]]:
    watch, found = LinkWatch(), []
    for k, (row, each) in enumerate(zip(torques, held, strict=True)):
        signals = tick(row, held=each)
        watch.sense(signals)
        felt = watch.step(USE, signals, 1.0)
        if felt is not None:
            found.append((k, felt))
    return found


@pytest.mark.parametrize(("size", "seen"), [(20.9, False), (23.1, True)])
def test_friction_at_rest_is_a_bound_beyond_which_deviations_count(size: float, seen: bool) -> None:
    """It may hold 8 N·m one way before, 8 the other way now, and 6 deviations of 1 N·m are noise: 22 N·m, not six times 8."""
    torques = stream(500, (0.0, 1.0, 0.0, 0.0, 0.0, 0.0), (START, 500, size), noise=0.01)
    assert bool(stood(torques, [HELD_BACK] * 500)) is seen


def test_a_hand_that_comes_in_a_second_is_told_where_friction_may_hide_it() -> None:
    """What is felt of it is followed in motion, and not while the arm stands."""
    torques = stream(1200, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), noise=0.1)
    torques[:, 1] += np.clip((np.arange(1200) - START) * 0.06, 0.0, 30.0) * (np.arange(1200) < 900)
    (at, gained), (off, lost) = stood(torques, [HELD_BACK] * 1200)
    assert (gained.change, lost.change) == (Change.GAINED, Change.LOST)
    assert START + 22.0 / 0.06 < at < START + 500
    assert 900 < off < 900 + HELD + GONE


def test_what_friction_held_as_the_arm_stood_is_no_contact_as_it_starts() -> None:
    """The motor lets go of 15 N·m that it held against friction, as the joint begins to slide, and what counts follows then."""
    torques = stream(900, (0.0, 1.0, 0.0, 0.0, 0.0, 0.0), (START, 500, 15.0), noise=0.1)
    assert not stood(torques, [HELD_BACK] * 500 + [np.zeros(6)] * 400)
