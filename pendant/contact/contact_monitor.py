"""All contact detectors side by side, of the tool and of the links, and the poses that they look back into (CD-2, CD-14)."""

from collections import deque

import numpy as np

from pendant.contact.contact_change import ArmPose, Contact
from pendant.contact.contact_limits import ContactLimits, limits, scale_of
from pendant.contact.contact_rules import Rule
from pendant.contact.detector import Detector, Finding
from pendant.contact.history import SIZE, SUMMED
from pendant.contact.link_contact import LINKS, LinkChange, LinkWatch
from pendant.contact.settings import ContactUse
from pendant.sensor.sensor_spec import USUAL, SensorSpec
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Mode
from pendant.tick.pose import flat, turned
from pendant.tick.source_signal import ContactSignals, Signal

TOOL = "tool"
AT_TOOL = ("force and tool-side acceleration", "force and arm-side acceleration")
"""Sources of the tool's force and acceleration, in the order of `Estimate.signals`; those of the links come after them."""
JOINTS = "joints"
"""Source of the links' force and acceleration."""
STILL = 0.2
"""Acceleration of a link that is none, for the noise of the encoders [m/s²]."""


class Poses:
    """Where the arm was in the last `SIZE` ticks."""

    __slots__ = ("_kept",)

    def __init__(self) -> None:
        self._kept: deque[tuple[bytes, bytes, bytes]] = deque(maxlen=SIZE)  # q, tcp, R_BF: bytes, for arrays take twice as long

    def push(self, estimate: Estimate) -> None:
        """Take one tick."""
        self._kept.append((estimate.q.tobytes(), estimate.tcp.tobytes(), estimate.R_BF.tobytes()))

    def at(self, age: int) -> ArmPose:
        """The pose of `age` ticks ago, 0 <= age < SIZE; something was pushed that long ago."""
        q, tcp, R_BF = (np.frombuffer(kept) for kept in self._kept[-1 - age])
        x, y, z = tcp[:3].tolist()
        return ArmPose(tuple(q.tolist()), (x, y, z), flat(R_BF.reshape(3, 3)))


class ContactMonitor:
    """Feeds the detectors in every tick and turns what they find into contacts in B.

    While nothing is to be detected, signals are merely kept; the detectors get them when they are asked again.
    """

    # The last samples of all sources and poses: more than all the rest of a state, and the same again after as many equal ticks.
    NOT_STATE = ("detectors", "links", "_poses", "_kept", "_limits", "_keys", "_sensor")

    def __init__(self, sensor: SensorSpec = USUAL) -> None:
        self._sensor = sensor
        self.detectors = tuple(Detector() for _ in AT_TOOL)
        self.links = LinkWatch()
        self._limits: list[ContactLimits | None] = [None] * len(AT_TOOL)
        self._keys: list[tuple[object, ...]] = [()] * len(AT_TOOL)
        self._poses = Poses()
        self._kept: deque[ContactSignals] = deque(maxlen=SUMMED)  # that the detectors have not got yet

    def now(self) -> ArmPose:
        """Where the arm is."""
        return self._poses.at(0)

    def restart(self) -> None:
        """The flange sensor is zeroed, which is no contact: what it said before counts no more."""
        self._kept.clear()
        for detector in self.detectors:
            detector.sense(None)
        self.links.gap()  # they are told what the sensor feels

    def step(self, estimate: Estimate, use: ContactUse, mode: Mode, on: bool) -> tuple[Contact, ...]:
        """One tick: buffers always, rules while `on` (CD-1, CD-4)."""
        self._poses.push(estimate)
        if not on:
            self._kept.append(estimate.signals)
            return ()
        if self._kept:
            self._catch_up()
        contacts: tuple[Contact, ...] = ()
        used = (use.tool, use.flange)
        for index, (detector, signal) in enumerate(zip(self.detectors, estimate.signals.each(0, len(AT_TOOL)), strict=False)):
            if signal is None and detector.history.count == 0:
                continue
            detector.sense(signal)
            if not used[index]:
                detector.forget()
            elif signal is not None:
                finding = detector.step(use, self._limit(index, signal, use, mode, speed=estimate.v_tcp))
                if finding is not None:
                    contacts += (self._at_tool(finding, AT_TOOL[index], estimate.tick, use.look_back),)
        felt = self._of_links(estimate, use, mode)
        return contacts if felt is None else (*contacts, self._at_link(felt, estimate.tick, use.look_back))

    def _of_links(self, estimate: Estimate, use: ContactUse, mode: Mode) -> LinkChange | None:
        links, signals = self.links, estimate.signals
        links.sense(signals)
        if not use.links or not use.slow:
            links.forget()
            return None
        return links.step(use, signals, scale_of(use, mode, estimate.v_tcp))

    def _catch_up(self) -> None:
        """Give the detectors what they missed; if that is more than is kept, what was before it counts no more."""
        for detector in self.detectors:
            detector.forget()
            if len(self._kept) == SUMMED:
                detector.sense(None)
        self.links.forget()
        if len(self._kept) == SUMMED:
            self.links.gap()
        for signals in self._kept:
            for detector, signal in zip(self.detectors, signals.each(0, len(AT_TOOL)), strict=False):
                detector.sense(signal)
            self.links.sense(signals)
        self._kept.clear()

    def _limit(self, index: int, signal: Signal, use: ContactUse, mode: Mode, *, speed: float) -> ContactLimits:
        key = (use, mode, signal.mass, signal.lever, signal.effective_mass, speed if use.speed_share else 0.0)
        limit = self._limits[index]
        if limit is None or key != self._keys[index]:
            mass, effective, sensor = signal.mass, signal.effective_mass, self._sensor
            limit = limits(use, mode, mass=mass, effective_mass=effective, speed=speed, lever=signal.lever, sensor=sensor)
            self._keys[index], self._limits[index] = key, limit
        return limit

    def _at_tool(self, finding: Finding, source: str, tick: int, look_back: bool) -> Contact:
        R_BF = self.now().R_BF
        force, acceleration = turned(R_BF, finding.force), turned(R_BF, finding.acceleration)
        steps, pose = self._begun(finding.steps, look_back)
        change, rule = finding.change, finding.rule.value
        return Contact(tick, change, rule, TOOL, source, force, acceleration, finding.ratio, steps, pose)

    def _at_link(self, felt: LinkChange, tick: int, look_back: bool) -> Contact:
        (fx, fy, fz), (ax, ay, az) = felt.force, felt.acceleration
        ratio = (fx * ax + fy * ay + fz * az) / max(ax * ax + ay * ay + az * az, STILL * STILL)
        steps, pose = self._begun(felt.steps, look_back)
        rule, part = Rule.SLOW.value, LINKS[felt.link]
        return Contact(tick, felt.change, rule, part, JOINTS, felt.force, felt.acceleration, ratio, steps, pose)

    def _begun(self, steps: int, look_back: bool) -> tuple[int, ArmPose]:
        """Steps back to where a contact began, and the pose there: a force is the mean of its tick, angles are of its end, when
        the contact is there already.
        """
        return (steps, self._poses.at(steps + 1)) if look_back else (0, self._poses.at(0))
