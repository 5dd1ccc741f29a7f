"""The way back after a refusal or a leaving: which joints to turn, a ghost of the posture, the way back behind a wall (FD-22)."""

import math

import numpy as np
import viser

from app.web.scene.ghost import Ghost
from app.web.widgets import svg
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour
from pendant.event_table import TABLE
from pendant.events.event import Event, Kind, posture_of
from pendant.events.event_row import Effect, Severity
from pendant.freedrive.state_machine import ASKED_FOR
from pendant.guided.endings import way_back
from pendant.tick.modes import Mode
from sim.arm.arm_file import Arm
from sim.arm.frames import matrix_from_quaternion
from sim.exchange.snapshot import Snapshot

AMBER = (230, 119, 0)
REACHED = math.radians(2.0)
"""The posture is reached when no joint is further from it."""

WALLS = frozenset({Kind.LEFT_WALL, Kind.STOPPED_WALL, Kind.REFUSED_WALL})
LENGTH = 0.1
"""Of the arrow that shows the way back behind a wall [m]; the way itself can be too short to be seen."""


class WayBack:
    """Its part of the pendant, and of the picture. It stays until the arm is back, the user ends free-drive, or a program runs.

    It is shown after what went wrong: an end of free-drive because nobody moved the arm asks for no return.
    """

    def __init__(self, server: viser.ViserServer, arm: Arm) -> None:
        self._joints = tuple(arm.chain.joints)
        self._cause: Event | None = None  # the newest refusal or leaving
        self._posture: tuple[float, ...] = ()
        self._tick = 0  # shown last
        self._wall: Event | None = None
        self._pointed: tuple[object, ...] = ()
        self.ghost = Ghost(server, arm, "/ghost/back", AMBER)
        self.text = Html(server.gui)
        nothing = np.zeros((1, 2, 3), dtype=np.float32)
        self.arrow = server.scene.add_arrows(
            "/back/arrow", nothing, AMBER, shaft_radius=0.006, head_radius=0.016, head_length=0.04, visible=False
        )
        self.label = server.scene.add_label("/back/label", "", visible=False, anchor="bottom-center")

    def show(self, snapshot: Snapshot, fresh: list[Event]) -> bool:
        """Show what is left of the way; True if anything changed."""
        if snapshot.decision.mode is Mode.RUN or snapshot.tick < self._tick:  # a program, or another beginning
            self._posture, self._wall = (), None
        self._tick = snapshot.tick
        for event in fresh:
            self._read(event)
        if self._reached(snapshot):
            self._posture, self._wall = (), None
        left = ""
        if self._posture:
            left = way_back(self._posture, tuple(snapshot.estimate.q.tolist()), self._joints)
        told = svg.note("To return to where free-drive began (orange)", left.replace("_", " "), Colour.AMBER) if left else ""
        return any([self.text.show(told), self.ghost.show(self._posture or None, snapshot, "way back"), self._point(snapshot)])

    def _read(self, event: Event) -> None:
        row = TABLE[event.kind]
        if event.kind is Kind.WAY_BACK and self._cause is not None and TABLE[self._cause.kind].severity >= Severity.WARNING:
            self._posture = posture_of(event.values)
        if event.kind in ASKED_FOR or row.effect is Effect.ENTER:
            self._wall = None
        if event.kind in ASKED_FOR:
            self._posture = ()
        if row.effect not in (Effect.INFO, Effect.TRY, Effect.ENTER):
            self._cause = event
            self._wall = event if event.kind in WALLS else None

    def _reached(self, snapshot: Snapshot) -> bool:
        if not self._posture:
            return False
        return max(abs(then - now) for then, now in zip(self._posture, snapshot.estimate.q.tolist(), strict=True)) < REACHED

    def _point(self, snapshot: Snapshot) -> bool:
        """Show which way, and how far, the part has to go to be behind the wall again."""
        told: tuple[object, ...] = ()
        if self._wall is not None:
            values, seen = self._wall.values, snapshot.estimate
            back = np.array([float(values[name]) for name in ("x", "y", "z")])
            p = {"flange": seen.p_BF, "tcp": seen.tcp[:3], "elbow": seen.elbow[:3]}[str(values["part"])]
            before = np.array([float(values[name]) for name in ("px", "py", "pz")])
            left = float(values["distance"]) + 1000.0 * float((before - p) @ back)  # [mm]
            if left > 0.0 and back.any():
                base = snapshot.truth_links[0]
                turn = matrix_from_quaternion(base[3:])
                tail = base[:3] + turn @ p
                tip = tail + turn @ back * LENGTH
                told = (*np.round(tail, 3).tolist(), *np.round(tip, 3).tolist(), f"{values['wall']}: {left:.1f} mm back")
        if told == self._pointed:
            return False
        self._pointed = told
        self.arrow.visible = self.label.visible = bool(told)
        if told:
            ends = np.array(told[:6], dtype=np.float32).reshape(1, 2, 3)
            self.arrow.points, self.label.position, self.label.text = ends, ends[0, 1], str(told[6])
        return True
