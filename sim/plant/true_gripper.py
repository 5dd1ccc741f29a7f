"""The true gripper: its fingers close on parts, or its cup draws them on; it holds them as long as friction does."""

from collections.abc import Callable

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.arm.frames import rotation_from_rpy
from sim.arm.scenario import AnyPart, Cup, Fingers, ToolModel
from sim.gripping.finger_drive import FingerDrive, GripperState, vacuum_force
from sim.gripping.finger_shape import FINGERS, THICKNESS, finger_poses, tip_height
from sim.gripping.grasp import Chord, chord, firm, seals
from sim.gripping.grip_strength import GripContact, load_on_grip, pad_radius, strength_taken
from sim.plant.changes import DriveGripper
from sim.plant.held_part import HeldParts

Array = NDArray[np.float64]

ROOM = 1e-4  # a part that both fingers touch is between them [m]


class TrueGripper:
    """What a gripper does in a tick. Truth.

    Args:
        model, data: MuJoCo's.
        tool: with the gripper.
        parts: that it can hold.
        flange: MuJoCo's number of the body F.
        velocity: tells the flange's velocity (3,) in W [m/s] at a point (3,) in W [m].
        span: of a tick [s].
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        tool: ToolModel,
        parts: HeldParts,
        *,
        flange: int,
        velocity: Callable[[Array], Array],
        span: float,
    ) -> None:
        assert tool.gripper is not None
        self._model, self._data, self._tool, self._parts = model, data, tool, parts
        self._kind, self._flange, self._velocity, self._span = tool.gripper, flange, velocity, span
        self._drive = FingerDrive(tool.gripper) if isinstance(tool.gripper, Fingers) else None
        self._point, self._R = np.array(tool.tcp), rotation_from_rpy(tool.rpy)
        self._tip = tip_height(tool)
        self._draws = False  # the cup does
        self._taken = 0.0
        self._spin = (0.0, 0.0, 0.0)  # of the flange, a tick before [rad/s]
        self._passing: set[str] = set()  # parts that the fingers do not touch
        self._slipped = ""  # a part that slid out of the grip, until the gripper opens
        self._lines = (False, False)  # close and open, as they were
        shapes = [model.geom(name).id for name in FINGERS] if self._drive is not None and _has(model, FINGERS[0]) else []
        self._shapes = np.array(shapes, dtype=int)

    @property
    def state(self) -> GripperState:
        """As it is now."""
        held = "" if self._parts.held is None else self._parts.held.name
        if self._drive is None:
            force = vacuum_force(self._kind) if isinstance(self._kind, Cup) and self._draws else 0.0
            return GripperState(self._draws, False, held, bool(held), force=force, taken=self._taken)
        drive = self._drive
        met = bool(held) and drive.wanted < drive.opening
        stroke = drive.fingers.stroke
        moving = drive.moving and not met
        return GripperState(drive.closing, moving, held, met, drive.opening, drive.wanted, stroke, drive.force, self._taken)

    @property
    def detected_input(self) -> int | None:
        """Number of the digital input that is high, as it holds a part; None: it holds none."""
        return None if self._parts.held is None else self._kind.detected_input

    def order(self, change: DriveGripper) -> None:
        """Do what a laboratory, a program or a client of it asks."""
        drive = self._drive
        if drive is None:
            if change.command in ("close", "open"):
                self._draws = change.command == "close"
            elif change.opening is not None:
                self._draws = change.opening == 0.0
            if not self._draws:
                self._slipped = ""
            return
        ends = {"close": 0.0, "open": drive.fingers.stroke}
        own, speed, force = drive.fingers, change.speed, change.force
        if change.speed_share is not None:
            speed = own.least_speed + change.speed_share * (own.most_speed - own.least_speed)
        if change.force_share is not None:
            force = own.least_force + change.force_share * (own.most_force - own.least_force)
        drive.order(ends.get(change.command or "", change.opening), speed, force)
        if change.command == "stop":
            drive.stop()

    def wired(self, high: int) -> None:
        """Follow the digital outputs, given as bits: where one of the two changes, and only one of them is on, it acts."""
        lines = bool(high >> self._kind.close_output & 1), bool(high >> self._kind.open_output & 1)
        if lines != self._lines:
            self._lines = lines
            if lines[0] != lines[1]:
                self.order(DriveGripper(command="close" if lines[0] else "open"))

    def step(self, motion: Array) -> None:
        """Go on for a tick that the physics has done.

        Args:
            motion: means over the tick at the origin of F, in F (6,): acceleration [m/s²] against gravity, turning [rad/s].
        """
        parts, drive = self._parts, self._drive
        if parts.held is not None:
            parts.follow()
            self._bear(parts.held, motion)
        elif drive is None:
            if self._draws:
                self._draw()
        elif drive.moving:
            self._close(drive) if drive.wanted < drive.opening else self._open(drive)
        elif self._passing:
            self._clear(drive)
        self._spin = (float(motion[3]), float(motion[4]), float(motion[5]))

    def drop(self) -> None:
        """Let what it holds fall, whatever the grip."""
        if self._parts.held is not None:
            self._lose()

    def _bear(self, part: AnyPart, motion: Array) -> None:
        """Hold a part, or let it slip or go."""
        drive, body = self._drive, self._parts.body
        if (drive is not None and drive.wanted > drive.opening) or (drive is None and not self._draws):
            self._parts.give(self._velocity)
            self._taken = 0.0
            if drive is not None:
                self._open(drive)
            return
        touched = self._parts.touched()
        now = motion[3:].tolist()
        x, y, z = ((after - before) / self._span for after, before in zip(now, self._spin, strict=True))
        load = load_on_grip(motion, (x, y, z), body, touched)
        self._taken = strength_taken(self._grip(part), load, body.com)
        if self._taken > 1.0 and not self._slide(part, touched):
            self._lose()

    def _slide(self, part: AnyPart, touched: Array) -> bool:
        """A part that something else holds slides in the grip, as far as friction gives way; False: it is out of the grip."""
        force = float(np.linalg.norm(touched[:3]))
        if force == 0.0:
            return False
        self._parts.slide(touched[:3] / force, 1.0 - 1.0 / self._taken)
        point, axes = self._frame()
        p, R = self._parts.held_pose()
        if self._drive is not None:
            return chord(part, R.T @ (point - p), R.T @ axes[:, 0]) is not None
        assert isinstance(self._kind, Cup)
        return seals(part, R.T @ (point - p), R.T @ axes, self._kind.radius)

    def _lose(self) -> None:
        """The part slides out; it cannot be gripped again before the gripper has opened."""
        part = self._parts.held
        assert part is not None
        self._parts.give(self._velocity)
        self._taken, self._slipped = 0.0, part.name

    def _grip(self, part: AnyPart) -> GripContact:
        """How it holds a part."""
        x, y, z = self._point.tolist()
        if self._drive is not None:
            a, b, c = self._R[:, 0].tolist()
            return GripContact((x, y, z), (a, b, c), True, self._drive.force, part.friction, pad_radius(self._drive.fingers.pad))
        assert isinstance(self._kind, Cup)
        a, b, c = (-self._R[:, 2]).tolist()
        return GripContact((x, y, z), (a, b, c), False, vacuum_force(self._kind), part.friction, self._kind.radius)

    def _frame(self) -> tuple[Array, Array]:
        """Tool centre point (3,) [m] and axes of the tool (3, 3), in W."""
        p, R = self._data.xpos[self._flange], self._data.xmat[self._flange].reshape(3, 3)
        return p + R @ self._point, R @ self._R

    def _draw(self) -> None:
        """A cup that draws takes the part on which it closes."""
        assert isinstance(self._kind, Cup)
        point, axes = self._frame()
        for part in self._parts.parts:
            p, R = self._parts.pose(part)
            if part.name != self._slipped and seals(part, R.T @ (point - p), R.T @ axes, self._kind.radius):
                self._parts.take(part, np.zeros(3))
                return

    def _close(self, drive: FingerDrive) -> None:
        """Fingers that close push a part between them to their middle, and take it when both touch it."""
        before = drive.opening
        drive.step(self._span)
        point, axes = self._frame()
        along = axes[:, 0]
        for part in self._parts.parts:
            found = self._between(part, point, along, before)
            slipped = part.name == self._slipped
            if found is not None and not firm(found, part.friction):
                found = None  # it is pushed out
            self._pass(part, slipped or found is not None)
            if slipped or found is None:
                continue
            width = found.end - found.begin
            if drive.opening <= width:
                drive.opening = width
                self._parts.take(part, -0.5 * (found.begin + found.end) * along)
                break
            half = 0.5 * drive.opening
            aside = max(-half - found.begin, 0.0) - max(found.end - half, 0.0)
            if aside:
                self._parts.shift(part, aside * along)
        self._show(drive)

    def _open(self, drive: FingerDrive) -> None:
        """Fingers that open leave what is between them alone."""
        drive.step(self._span)
        drive.closing = False
        self._slipped = ""
        self._show(drive)

    def _clear(self, drive: FingerDrive) -> None:
        """Fingers that stand still touch again what is not in them any more."""
        for part in [part for part in self._parts.parts if part.name in self._passing]:
            if not self._meets(part, drive):
                self._pass(part, False)

    def _meets(self, part: AnyPart, drive: FingerDrive) -> bool:
        """A finger is in a part: looked at by lines through both of them, from the tips to the palm."""
        point, axes = self._frame()
        p, R = self._parts.pose(part)
        own, tip = drive.fingers, self._tip
        inner = 0.5 * drive.opening
        outer = inner + THICKNESS
        if float(np.linalg.norm(point - p)) > float(np.linalg.norm(part.size)) + own.finger + outer:
            return False
        for height in (tip, 0.5 * tip, 0.0, 0.5 * (tip - own.finger), tip - own.finger):
            found = chord(part, R.T @ (point + height * axes[:, 2] - p), R.T @ axes[:, 0])
            if found is None:
                continue
            left, right = found.begin < -inner and found.end > -outer, found.end > inner and found.begin < outer
            if left or right:
                return True
        return False

    def _between(self, part: AnyPart, point: Array, along: Array, opening: float) -> Chord | None:
        """The stretch of the fingers' way that lies in a part which is between them."""
        p, R = self._parts.pose(part)
        if float(np.dot(point - p, point - p)) > (max(part.size) + opening) ** 2:
            return None
        found = chord(part, R.T @ (point - p), R.T @ along)
        half = 0.5 * opening + ROOM
        return None if found is None or found.begin < -half or found.end > half else found

    def _pass(self, part: AnyPart, passes: bool) -> None:
        if passes is not (part.name in self._passing):
            self._passing ^= {part.name}
            self._parts.let_pass(part, passes)

    def _show(self, drive: FingerDrive) -> None:
        """Have the shapes of the fingers be where the fingers are."""
        if self._shapes.size:
            self._model.geom_pos[self._shapes] = finger_poses(self._tool, drive.fingers, drive.opening)[:, :3]


def _has(model: mujoco.MjModel, name: str) -> bool:
    return mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, name) >= 0
