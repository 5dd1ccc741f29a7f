"""What a user teaches: waypoints and a program of steps between them, as one file."""

import math
from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from pendant.program.reaction import Until
from pendant.program.steps import AnyStep, JointMove, LinearMove, Program, SwitchTool, Wait, WaitForContact, ZeroSensor
from pendant.settings.bounds import MOST_JOINTS, Angle
from sim.arm.scenario import Vector

Name = Annotated[str, Meta(min_length=1, max_length=40)]

MOST = 200
"""Waypoints, and steps, in one file."""

JOINT_SPEED, LINE_SPEED, TOUCH_SPEED = 0.4, 0.25, 0.05
"""At full speed: of a joint move, as a share of the joints' limits; of a line, and of a line until contact [m/s]."""

MOVES = {"joint": "Move to", "line": "Line to", "touch": "Touch on the way to"}
WAITS = {
    "wait": "Wait 1 s",
    "contact": "Wait for a contact",
    "tool on": "Tool on",
    "tool off": "Tool off",
    "zero": "Zero the force sensor",
}


class Waypoint(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A posture that was registered."""

    name: Name
    q: Annotated[list[Angle], Meta(max_length=MOST_JOINTS)]  # (n,) joint angles [rad]
    position: Vector  # of the tool centre point in B [m]
    quaternion: Annotated[list[float], Meta(min_length=4, max_length=4)]  # of the tool in B, wxyz

    def __post_init__(self) -> None:
        """Check that the quaternion is an orientation."""
        length = math.hypot(*self.quaternion)
        if not abs(length - 1.0) <= 1e-3:
            raise ValueError(f"quaternion: its length is {length:.4g}, allowed: 1 (wxyz)")


class TaughtStep(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A step of the program: a move to a waypoint, or what needs none."""

    do: Literal["joint", "line", "touch", "wait", "contact", "tool on", "tool off", "zero"]
    to: Name | None = None  # the waypoint

    def __post_init__(self) -> None:
        """Check that a move, and only a move, has a waypoint."""
        if (self.to is not None) != (self.do in MOVES):
            raise ValueError(f"to: {self.do!r} {'needs' if self.do in MOVES else 'has no'} waypoint")

    @property
    def text(self) -> str:
        """The step in words."""
        return WAITS[self.do] if self.to is None else f"{MOVES[self.do]} {self.to}"


class Lesson(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """All that was taught. Without steps, the program visits the waypoints in order."""

    waypoints: Annotated[list[Waypoint], Meta(max_length=MOST)] = []
    steps: Annotated[list[TaughtStep], Meta(max_length=MOST)] = []

    def __post_init__(self) -> None:
        """Check that names are unique and known."""
        names = [waypoint.name for waypoint in self.waypoints]
        if len(set(names)) != len(names):
            raise ValueError("waypoints: two have the same name")
        for step in self.steps:
            if step.to is not None and step.to not in names:
                raise ValueError(f"steps: there is no waypoint {step.to!r}")

    def find(self, name: str) -> Waypoint:
        """The waypoint of that name; KeyError: there is none."""
        for waypoint in self.waypoints:
            if waypoint.name == name:
                return waypoint
        raise KeyError(name)

    @property
    def plan(self) -> list[TaughtStep]:
        """The steps to run."""
        return self.steps or [TaughtStep(do="joint", to=waypoint.name) for waypoint in self.waypoints]

    def free_name(self) -> str:
        """A name that no waypoint has."""
        names = {waypoint.name for waypoint in self.waypoints}
        return next(name for name in (f"P{number}" for number in range(1, MOST + 2)) if name not in names)

    def with_waypoint(self, waypoint: Waypoint) -> "Lesson":
        """With one more waypoint at the end."""
        return Lesson(waypoints=[*self.waypoints, waypoint], steps=self.steps)

    def without(self, name: str) -> "Lesson":
        """Without a waypoint and the steps that lead to it."""
        steps = [step for step in self.steps if step.to != name]
        return Lesson(waypoints=[waypoint for waypoint in self.waypoints if waypoint.name != name], steps=steps)

    def renamed(self, name: str, new: str) -> "Lesson":
        """With another name for a waypoint."""
        waypoints = [msgspec.structs.replace(w, name=new) if w.name == name else w for w in self.waypoints]
        return Lesson(waypoints=waypoints, steps=[TaughtStep(do=s.do, to=new if s.to == name else s.to) for s in self.steps])

    def moved(self, name: str, by: int) -> "Lesson":
        """With a waypoint moved up (-1) or down (1) in the list."""
        waypoints = list(self.waypoints)
        at = waypoints.index(self.find(name))
        to = min(max(at + by, 0), len(waypoints) - 1)
        waypoints.insert(to, waypoints.pop(at))
        return Lesson(waypoints=waypoints, steps=self.steps)

    def with_steps(self, steps: list[TaughtStep]) -> "Lesson":
        """With another program."""
        return Lesson(waypoints=self.waypoints, steps=steps)


def program(lesson: Lesson, steps: list[TaughtStep], speed: float, name: str = "taught") -> Program:
    """The program of some steps at a share of full speed, 0 < speed <= 1."""
    return Program(name=name, steps=tuple(_move(lesson, step, speed) for step in steps))


def _move(lesson: Lesson, step: TaughtStep, speed: float) -> AnyStep:
    if step.to is None:
        if step.do == "wait":
            return Wait(duration=1.0)
        if step.do == "zero":
            return ZeroSensor()
        return WaitForContact() if step.do == "contact" else SwitchTool(on=step.do == "tool on")
    target = lesson.find(step.to)
    if step.do == "joint":
        return JointMove(q=tuple(target.q), speed=JOINT_SPEED * speed, acceleration=0.25)
    x, y, z = target.position
    w, i, j, k = target.quaternion
    touching = step.do == "touch"
    return LinearMove(
        position=(x, y, z),
        quaternion=(w, i, j, k),
        speed=(TOUCH_SPEED if touching else LINE_SPEED) * speed,
        acceleration=0.5,
        until=Until(then="retract") if touching else None,
    )
