"""Decisions and snapshots to feed to time lines and watches, without a simulation."""

from enum import EnumType
from typing import Any

import numpy as np

from pendant.decision import Decision
from pendant.events.event import Event, Kind
from pendant.freedrive.periods import Remaining
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law, Mode, Phase, Safety
from sim.exchange.desk import Wishes
from sim.exchange.snapshot import Snapshot

JOINTS = ["base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3"]


def decision(
    mode: Mode = Mode.TEACH,
    phase: Phase = Phase.OFF,
    safety: Safety = Safety.NORMAL,
    events: tuple[Event, ...] = (),
    periods: tuple[Remaining, ...] = (),
) -> Decision:
    return Decision(
        mode=mode,
        safety=safety,
        phase=phase,
        law=Law.HOLD,
        move=None,
        gain=0.0,
        force_cap=50.0,
        baseline=(0.0,) * 6,
        periods=periods,
        events=events,
    )


def happened(kind: Kind, tick: int, **values: float | str) -> Decision:
    return decision(events=(Event(kind, tick, dict(values)),))


def estimate(**changed: Any) -> Estimate:
    values: dict[str, Any] = {}
    for name, hint in Estimate.__annotations__.items():
        blank = next(iter(hint)) if isinstance(hint, EnumType) else np.zeros(6) if "ndarray" in str(hint) else hint()
        values[name] = True if hint is bool else blank
    return Estimate(**{**values, **changed})


def snapshot(
    tick: int, flange: tuple[float, ...] = (0.0, 0.0, 0.0), quaternion: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0), **measured: Any
) -> Snapshot:
    links = np.zeros((8, 7))
    links[:, 3] = 1.0
    links[-1] = [*flange, *quaternion]
    links[3, :3] = [7.0, 8.0, 9.0]  # the elbow's link
    return Snapshot(tick, decision(), estimate(**measured), links, np.zeros((0, 7)), None, 2.5, 0.0, ())


class FakeSimulation:
    """Reads back what it is told: enters free-drive while the button is held, moves the flange with the pushed force."""

    def __init__(self) -> None:
        self.wishes: list[Wishes] = []

    def tick(self, wishes: Wishes) -> Decision:
        self.wishes.append(wishes)
        mode = Mode.FREE_DRIVE if wishes.inputs.held else Mode.TEACH
        return decision(mode)

    def snapshot(self) -> Snapshot:
        return snapshot(len(self.wishes), (0.001 * len(self.wishes), 0.0, 0.0))

    def glance(self) -> Snapshot:
        return self.snapshot()
