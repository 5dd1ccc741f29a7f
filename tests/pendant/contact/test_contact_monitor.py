"""All detectors on estimates: axes of B, pose at the first suspicious sample, switches, sources (CD-1, CD-2, CD-14)."""

import weakref

import msgspec
import numpy as np
import pytest

from pendant.contact import contact_monitor
from pendant.contact.contact_change import Change, Contact
from pendant.contact.contact_limits import limits
from pendant.contact.contact_monitor import AT_TOOL, JOINTS, ContactMonitor, Poses
from pendant.contact.history import SIZE, SUMMED
from pendant.contact.settings import ContactUse
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Mode
from pendant.tick.source_signal import ContactSignals, Signal
from tests.pendant.contacts import USE, on_links, ramp, signals
from tests.pendant.estimates import estimate

START = 100
QUARTER = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # F turned by 90 degrees about z of B


def estimates(source: int, stream: list[Signal | None]) -> list[Estimate]:
    result = []
    for k, signal in enumerate(stream, 1):
        now = estimate(tick=k)
        now.R_BF, now.q = QUARTER, np.full(6, 0.001 * k)
        now.tcp = np.array([0.0002 * k, 0.0, 0.5, 0.0, 0.0, 0.0])
        valid = tuple(index == source and signal is not None for index in range(4))
        now.signals = ContactSignals(np.tile(signal or Signal(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 4), valid)
        result.append(now)
    return result


def run(source: int, stream: list[Signal | None], use: ContactUse = USE, on: bool = True) -> list[Contact]:
    monitor = ContactMonitor()
    return [contact for now in estimates(source, stream) for contact in monitor.step(now, use, Mode.RUN, on)]


def test_a_contact_is_told_in_axes_of_the_base_with_its_pose() -> None:
    (contact,) = run(0, [*signals(200, push=ramp(200, START, 8.0, top=40.0))])
    assert contact.change is Change.GAINED
    assert (contact.part, contact.source) == ("tool", AT_TOOL[0])
    assert contact.force[1] > 0.9 * np.linalg.norm(contact.force)  # x of F is y of B
    assert contact.acceleration[1] < 0.0
    first = contact.tick - contact.steps
    assert abs(first - START - 1) <= 2
    assert contact.pose.q == pytest.approx((0.001 * (first - 1),) * 6)
    assert contact.pose.p_BT == pytest.approx((0.0002 * (first - 1), 0.0, 0.5))
    assert tuple(QUARTER.ravel().tolist()) == contact.pose.R_BF


def test_switched_off_it_fills_its_buffers_and_finds_nothing() -> None:
    stream = [*signals(200, push=ramp(200, START, 8.0, top=40.0))]
    assert run(0, stream, on=False) == []
    monitor = ContactMonitor()
    found = []
    for now in estimates(0, stream):
        found += monitor.step(now, USE, Mode.RUN, now.tick > START - 2)
    assert len(found) == 1  # at once, since the buffers were full


def test_it_knows_where_the_arm_is_whether_it_detects_or_not() -> None:
    monitor, rest = ContactMonitor(), [None] * 2
    for now, on in zip(estimates(0, [*rest]), (False, True), strict=True):
        monitor.step(now, USE, Mode.RUN, on)
        assert monitor.now().q == tuple(now.q.tolist())


def test_a_source_that_is_switched_off_finds_nothing() -> None:
    """CD-2."""
    stream = [*signals(200, push=ramp(200, START, 8.0, top=40.0))]
    off = msgspec.structs.replace(USE, tool=False)
    assert len(run(0, stream)) == 1
    assert run(0, stream, off) == []


@pytest.mark.parametrize("quiet", [START - 2, SUMMED - 1, SUMMED, SUMMED + 60])
def test_however_long_it_was_off_it_finds_a_contact_at_once(quiet: int) -> None:
    monitor, found = ContactMonitor(), []
    for now in estimates(0, [*signals(quiet + 100, push=ramp(quiet + 100, quiet, 8.0, top=40.0))]):
        found += monitor.step(now, USE, Mode.RUN, now.tick > quiet)
    assert len(found) == 1
    assert 0 < found[0].tick - quiet <= 10


def test_a_source_that_is_not_valid_gives_nothing() -> None:
    stream: list[Signal | None] = [*signals(200, push=ramp(200, START, 8.0, top=40.0))]
    stream[START - 5 : START + 8] = [None] * 13
    assert run(0, stream) == []
    assert run(0, [None] * 50) == []


def test_limits_follow_the_settings_at_once() -> None:
    stream = signals(400, push=ramp(400, START, 0.05, top=2.0))
    monitor, dull, found = ContactMonitor(), msgspec.structs.replace(USE, sensitivity=0.25, speed_share=1.0), []
    for now in estimates(0, [*stream]):
        found += monitor.step(now, dull if now.tick < 300 else USE, Mode.RUN, True)
    assert found
    assert all(contact.tick >= 300 for contact in found)


@pytest.mark.parametrize(("missed", "known"), [(10, 61), (SUMMED - 1, SUMMED + 50), (SUMMED, SUMMED), (SUMMED + 60, SUMMED)])
def test_what_was_missed_is_caught_up_on_and_what_is_lost_is_a_gap(missed: int, known: int) -> None:
    """CD-4: the buffers are filled always."""
    monitor = ContactMonitor()
    for now in estimates(0, [*signals(50 + missed + 1)]):
        monitor.step(now, USE, Mode.RUN, not 50 < now.tick <= 50 + missed)
    assert monitor.detectors[0].history.count == known


@pytest.mark.parametrize("look_back", [True, False])
def test_the_pose_is_where_the_first_suspicious_sample_began_or_of_now(look_back: bool) -> None:
    """CD-14: a contact so gentle that it takes long to be seen. A force is the mean of its tick, angles are of its end."""
    use = msgspec.structs.replace(USE, look_back=look_back)
    (contact,) = run(0, [*signals(300, push=ramp(300, START, 0.1, top=6.0), noise=0.3)], use)
    assert contact.steps > 5 if look_back else contact.steps == 0
    begin = contact.tick - contact.steps - look_back
    assert contact.pose.q == pytest.approx((0.001 * begin,) * 6)


def test_the_ratio_is_told_of_a_hard_contact() -> None:
    """CD-16: 1 kg carried by 2 kg of arm: the object brakes both, so its force over their acceleration is 3 kg."""
    (contact,) = run(0, [*signals(200, push=ramp(200, START, 8.0, top=40.0), noise=0.2)])
    assert contact.ratio == pytest.approx(-3.0, abs=0.2)


@pytest.mark.parametrize(("lever", "seen"), [(0.0, True), (0.3, True), (0.5, False)])
def test_what_turning_adds_to_the_noise_is_told_from_a_contact(lever: float, seen: bool) -> None:
    """CD-0: 0.5 m of 1.2 rad/s² add 0.5 m/s² to the noise, and 4.2 times of it hide a change of 2 m/s²; 0.3 m do not."""
    use = msgspec.structs.replace(USE, slow=False, statistical=False, retrospective=False)
    stream = [signal._replace(lever=lever) for signal in signals(120, push=ramp(120, START, 6.0, top=6.0), noise=0.0)]
    assert bool(run(0, [*stream], use)) is seen


@pytest.mark.parametrize(
    ("mode", "speed", "seen"), [(Mode.RUN, 0.0, True), (Mode.FREE_DRIVE, 0.0, False), (Mode.RUN, 1.0, False)]
)
def test_thresholds_follow_mode_and_speed_as_they_change(mode: Mode, speed: float, seen: bool) -> None:
    """CD-11: a contact that is found at rest in RUN is not in FREE_DRIVE, nor where the arm is fast by then."""
    use = msgspec.structs.replace(USE, speed_share=2.0, slow=False, statistical=False)
    monitor, found = ContactMonitor(), []
    for now in estimates(0, [*signals(200, push=ramp(200, START, 1.5, top=6.0), noise=0.3)]):
        now.v_tcp = 0.0 if now.tick < START else speed
        found += monitor.step(now, use, mode, True)
    assert bool(found) is seen


def test_poses_are_kept_for_so_many_ticks_and_no_longer() -> None:
    poses = Poses()
    for now in estimates(0, [None] * (SIZE + 1)):
        poses.push(now)
    assert poses.at(SIZE - 1).q == pytest.approx((0.002,) * 6)
    with pytest.raises(IndexError):
        poses.at(SIZE)


def test_what_is_kept_while_it_is_off_does_not_grow_without_end() -> None:
    monitor, kept = ContactMonitor(), []
    for now in estimates(0, [None] * (SUMMED + 5)):
        kept.append(weakref.ref(now.signals.numbers))
        monitor.step(now, USE, Mode.RUN, on=False)
    del now
    assert [each() is None for each in kept] == [True] * 5 + [False] * SUMMED


@pytest.mark.parametrize("before", [1, 2, 3])
def test_a_sample_that_is_missing_is_a_gap_however_few_were_before(before: int) -> None:
    monitor = ContactMonitor()
    for now in estimates(0, [*signals(before), None, *signals(2)]):
        monitor.step(now, USE, Mode.RUN, on=True)
    assert monitor.detectors[0].history.count == 2


def test_what_several_sources_find_in_the_same_tick_is_all_told() -> None:
    """CD-2."""
    monitor, found, use = ContactMonitor(), [], msgspec.structs.replace(USE, flange=True)
    for now in estimates(0, [*signals(200, push=ramp(200, START, 8.0, top=40.0))]):
        now.signals = ContactSignals(now.signals.numbers, (True, True, False, False))
        found.append([contact.source for contact in monitor.step(now, use, Mode.RUN, on=True)])
    assert [told for told in found if told] == [[AT_TOOL[0], AT_TOOL[1]]]


def found(source: int, stream: list[Signal | None], zeroed: int = 0, quiet: range = range(0)) -> list[Contact]:
    """Contacts where the sensor is zeroed in a tick, while nobody looks for one in those that are `quiet`."""
    monitor, contacts = ContactMonitor(), list[Contact]()
    for now in estimates(source, stream):
        contacts += monitor.step(now, USE, Mode.RUN, now.tick not in quiet)
        if now.tick == zeroed:
            monitor.restart()
    return contacts


@pytest.mark.parametrize("quiet", [range(0), range(START - 20, START + 2)], ids=["listening", "not listening"])
def test_a_sensor_that_is_zeroed_is_no_contact(quiet: range) -> None:
    """A force that steps by 30 N; also where somebody looks for contacts only just afterwards."""
    stream: list[Signal | None] = [s if k < START else s._replace(fx=s.fx + 30.0) for k, s in enumerate(signals(400))]
    assert found(0, stream, quiet=quiet) != []
    assert found(0, stream, zeroed=START, quiet=quiet) == []


@pytest.mark.parametrize(("speed_share", "made"), [(0.0, 1), (1.0, 30)])
def test_limits_are_made_when_what_they_come_from_changes(speed_share: float, made: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The arm's speed is one of that only where it counts. To make them takes as long as all the rules."""
    asked = list[object]()
    monkeypatch.setattr(contact_monitor, "limits", lambda *what, **how: asked.append(what) or limits(*what, **how))
    use, monitor = msgspec.structs.replace(USE, speed_share=speed_share), ContactMonitor()
    for now in estimates(0, [*signals(30)]):
        now.v_tcp = 0.001 * now.tick
        monitor.step(now, use, Mode.RUN, on=True)
    assert len(asked) == made


def linked(n: int, push: float, begin: int = START, end: int = 10**6) -> list[Estimate]:
    """A hand on the elbow turns the two joints before it, and the force at both links is that of the arm on the hand."""
    result = estimates(2, [None] * n)
    rng = np.random.default_rng(3)
    for k, now in enumerate(result):
        size = push if begin <= k < end else 0.0
        link = Signal(-size, 0.0, 0.0, 0.1 * size, 0.0, 9.81)
        torques = rng.normal(0.0, 0.1, 6) + 0.4 * size * np.array([0.2, 1.0, 0.0, 0.0, 0.0, 0.0])
        now.signals = on_links(link, torques, np.ones(6), (np.zeros((6, 1)), np.zeros((6, 1)), np.zeros((6, 1))))
    return result


def felt(stream: list[Estimate], use: ContactUse = USE, zeroed: int = 0) -> list[Contact]:
    monitor, contacts = ContactMonitor(), list[Contact]()
    for now in stream:
        contacts += monitor.step(now, use, Mode.RUN, on=True)
        if now.tick == zeroed:
            monitor.restart()
    return contacts


def test_a_push_on_a_link_is_told_as_it_is() -> None:
    """CD-2: in axes of the base, as a contact that is gained, and as it goes, lost."""
    gained, lost = felt(linked(500, 80.0, end=300))
    assert (gained.change, lost.change) == (Change.GAINED, Change.LOST)
    assert {(contact.part, contact.source, contact.rule) for contact in (gained, lost)} == {("elbow", JOINTS, "slow")}
    assert gained.force[0] == pytest.approx(-80.0, rel=0.05)
    assert gained.ratio == pytest.approx(-10.0)
    assert abs(gained.tick - gained.steps - START - 1) <= 1
    assert gained.pose.q == pytest.approx((0.001 * (gained.tick - gained.steps - 1),) * 6)


@pytest.mark.parametrize(("name", "seen"), [("links", False), ("slow", False), ("statistical", True), ("tool", True)])
def test_the_slow_rule_watches_the_links(name: str, seen: bool) -> None:
    """CD-2."""
    assert bool(felt(linked(300, 80.0), msgspec.structs.replace(USE, **{name: False}))) is seen


@pytest.mark.parametrize(
    ("mode", "sensitivity", "seen"), [(Mode.RUN, 1.0, True), (Mode.FREE_DRIVE, 1.0, False), (Mode.RUN, 0.3, False)]
)
def test_bounds_of_the_links_follow_mode_and_sensitivity(mode: Mode, sensitivity: float, seen: bool) -> None:
    """CD-11, CD-12: 9.6 N·m, where the bound is 6 N·m."""
    use, monitor = msgspec.structs.replace(USE, sensitivity=sensitivity), ContactMonitor()
    assert any(monitor.step(now, use, mode, on=True) for now in linked(300, 24.0)) is seen


def test_links_count_a_zeroed_sensor_as_a_gap() -> None:
    """What the flange sensor feels is not the links', so its step is one of theirs."""
    assert len(felt(linked(300, 80.0))) == 1
    assert felt(linked(300, 80.0), zeroed=START) == []


@pytest.mark.parametrize(("missed", "known"), [(10, 61), (SUMMED, SUMMED + 1)])
def test_links_catch_up_on_what_was_missed(missed: int, known: int) -> None:
    """CD-4."""
    monitor = ContactMonitor()
    for now in linked(50 + missed + 1, 0.0):
        monitor.step(now, USE, Mode.RUN, not 50 < now.tick <= 50 + missed)
    assert monitor.links.torques.count == known
