"""All contact detectors side by side, one for each part and source, and the poses that they look back into (CD-2, CD-14)."""

from collections import deque
from typing import NamedTuple

import msgspec
import numpy as np

from pendant.contact.contact_change import ArmPose, Contact
from pendant.contact.contact_limits import ContactLimits, limits
from pendant.contact.detector import Detector, Finding
from pendant.contact.history import SIZE, SUMMED
from pendant.contact.settings import ContactUse
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Mode
from pendant.tick.pose import flat, turned
from pendant.tick.source_signal import ContactSignals, Signal


class Source(NamedTuple):
    """Where one detector's force and acceleration come from."""

    part: str  # that touches
    source: str
    in_base: bool  # its axes are those of B, not of F


SOURCES = (
    Source("tool", "force and tool-side acceleration", False),
    Source("tool", "force and arm-side acceleration", False),
    Source("elbow", "joints", True),
    Source("forearm", "joints", True),
)
"""In the order of `Estimate.signals`."""


def for_links(use: ContactUse) -> ContactUse:
    """The settings of the detectors that live on the joints.

    Force and acceleration of a link come from the same encoders, whose errors look like a contact to every rule that asks for
    opposite directions; only a force that lasts is told from them.
    """
    off = dict.fromkeys(("instant", "difference", "ratio", "ratio_of_values", "statistical"), False)
    return msgspec.structs.replace(use, **off)


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
    NOT_STATE = ("detectors", "_poses", "_kept", "_limits", "_keys", "_use", "_on_links", "_used")

    def __init__(self) -> None:
        self.detectors = tuple(Detector() for _ in SOURCES)
        self._limits: list[ContactLimits | None] = [None] * len(SOURCES)
        self._keys: list[tuple[object, ...]] = [()] * len(SOURCES)
        self._use: ContactUse | None = None
        self._on_links = ContactUse()
        self._used = (False,) * len(SOURCES)
        self._poses = Poses()
        self._kept: deque[ContactSignals] = deque(maxlen=SUMMED)  # that the detectors have not got yet

    def now(self) -> ArmPose:
        """Where the arm is."""
        return self._poses.at(0)

    def restart(self) -> None:
        """The flange sensor is zeroed, which is no contact: what it said before counts no more."""
        kept = bool(self._kept)  # then none of the detectors has got what the others have
        self._kept.clear()
        for detector, source in zip(self.detectors, SOURCES, strict=True):
            if kept or not source.in_base:
                detector.sense(None)

    def step(self, estimate: Estimate, use: ContactUse, mode: Mode, on: bool) -> tuple[Contact, ...]:
        """One tick: buffers always, rules while `on` (CD-1, CD-4)."""
        self._poses.push(estimate)
        if not on:
            self._kept.append(estimate.signals)
            return ()
        if self._kept:
            self._catch_up()
        if use is not self._use:
            self._use, self._on_links = use, for_links(use)
            self._used = (use.tool, use.flange, use.links, use.links)
        contacts: tuple[Contact, ...] = ()
        for index, signal in enumerate(estimate.signals.each()):
            detector = self.detectors[index]
            if signal is None and detector.history.count == 0:
                continue
            detector.sense(signal)
            if not self._used[index]:
                detector.forget()
            elif signal is not None:
                rules = self._on_links if SOURCES[index].in_base else use
                finding = detector.step(rules, self._limit(index, signal, use, mode, speed=estimate.v_tcp))
                if finding is not None:
                    contacts += (self._contact(finding, SOURCES[index], estimate.tick, use.look_back),)
        return contacts

    def _catch_up(self) -> None:
        """Give the detectors what they missed; if that is more than is kept, what was before it counts no more."""
        for detector in self.detectors:
            detector.forget()
            if len(self._kept) == SUMMED:
                detector.sense(None)
        for signals in self._kept:
            for detector, signal in zip(self.detectors, signals.each(), strict=False):
                detector.sense(signal)
        self._kept.clear()

    def _limit(self, index: int, signal: Signal, use: ContactUse, mode: Mode, *, speed: float) -> ContactLimits:
        key = (use, mode, signal.mass, signal.lever, signal.effective_mass, speed if use.speed_share else 0.0)
        limit = self._limits[index]
        if limit is None or key != self._keys[index]:
            links = SOURCES[index].in_base
            mass, effective = signal.mass, signal.effective_mass
            limit = limits(use, mode, mass=mass, effective_mass=effective, speed=speed, link=links, lever=signal.lever)
            self._keys[index], self._limits[index] = key, limit
        return limit

    def _contact(self, finding: Finding, source: Source, tick: int, look_back: bool) -> Contact:
        steps = finding.steps if look_back else 0
        # A force is the mean of its tick, angles are of its end, when the contact is there: where it began, it was not yet.
        now, pose = self.now(), self._poses.at(steps + 1 if look_back else 0)
        force, acceleration = finding.force, finding.acceleration
        if not source.in_base:
            force, acceleration = turned(now.R_BF, force), turned(now.R_BF, acceleration)
        change, rule = finding.change, finding.rule.value
        return Contact(tick, change, rule, source.part, source.source, force, acceleration, finding.ratio, steps, pose)
