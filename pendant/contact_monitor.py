"""All contact detectors side by side, one for each part and source, and the poses that they look back into (CD-2, CD-14)."""

from typing import NamedTuple

import msgspec

from pendant.contact import ArmPose, Contact
from pendant.contact_limits import ContactLimits, limits
from pendant.detector import Detector, Finding
from pendant.estimate import Estimate
from pendant.history import MASK, SIZE
from pendant.modes import Mode
from pendant.pose import UNTURNED, flat, turned
from pendant.settings import ContactUse
from pendant.signal import Signal


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


class ContactMonitor:
    """Feeds the detectors in every tick and turns what they find into contacts in B."""

    def __init__(self) -> None:
        self.detectors = tuple(Detector() for _ in SOURCES)
        self._limits: list[ContactLimits | None] = [None] * len(SOURCES)
        self._keys: list[tuple[object, ...]] = [()] * len(SOURCES)
        self._use: ContactUse | None = None
        self._on_links = ContactUse()
        self._used = (False,) * len(SOURCES)
        self.now = ArmPose((), (0.0, 0.0, 0.0), UNTURNED)  # where the arm is
        self._poses: list[ArmPose | None] = [None] * SIZE

    def step(self, estimate: Estimate, use: ContactUse, mode: Mode, on: bool) -> tuple[Contact, ...]:
        """One tick: buffers always, rules while `on` (CD-1, CD-4)."""
        tick = estimate.tick
        x, y, z = estimate.tcp.tolist()[:3]
        self.now = now = self._poses[tick & MASK] = ArmPose(tuple(estimate.q.tolist()), (x, y, z), flat(estimate.R_BF))
        if use is not self._use:
            self._use, self._on_links = use, for_links(use)
            self._used = (use.tool, use.flange, use.links, use.links)
        contacts: tuple[Contact, ...] = ()
        for index, signal in enumerate(estimate.signals):
            detector = self.detectors[index]
            if signal is None and detector.history.count == 0:
                continue
            detector.sense(signal)
            if not (on and self._used[index]):
                detector.forget()
            elif signal is not None:
                rules = self._on_links if SOURCES[index].in_base else use
                finding = detector.step(rules, self._limit(index, signal, estimate.v_tcp, use, mode))
                if finding is not None:
                    contacts += (self._contact(finding, SOURCES[index], tick, now, use.look_back),)
        return contacts

    def _limit(self, index: int, signal: Signal, speed: float, use: ContactUse, mode: Mode) -> ContactLimits:
        key = (use, mode, signal.mass, signal.effective_mass, speed if use.speed_share else 0.0)
        limit = self._limits[index]
        if limit is None or key != self._keys[index]:
            links = SOURCES[index].in_base
            limit = limits(use, signal.mass, signal.effective_mass, speed, mode, links)
            self._keys[index], self._limits[index] = key, limit
        return limit

    def _contact(self, finding: Finding, source: Source, tick: int, now: ArmPose, look_back: bool) -> Contact:
        steps = finding.steps if look_back else 0
        pose = self._poses[(tick - steps) & MASK] or now
        force, acceleration = finding.force, finding.acceleration
        if not source.in_base:
            force, acceleration = turned(now.R_BF, force), turned(now.R_BF, acceleration)
        change, rule = finding.change, finding.rule.value
        return Contact(tick, change, rule, source.part, source.source, force, acceleration, finding.ratio, steps, pose)
