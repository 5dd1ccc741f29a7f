"""What a user teaches: waypoints and a program of steps between them, as one file."""

import math
from typing import Annotated, Literal, TypeVar

import msgspec
from msgspec import Meta
from msgspec.structs import replace

from pendant.program.reaction import Until
from pendant.program.steps import (
    MOST_RUNS,
    AnyStep,
    ContactMove,
    InputLevel,
    JointMove,
    LinearMove,
    LineNumber,
    Program,
    SetOutput,
    SwitchTool,
    Tell,
    Wait,
    WaitForContact,
    WaitForInput,
    ZeroSensor,
)
from pendant.settings.bounds import MOST_JOINTS, Angle
from sim.arm.scenario import Vector

Name = Annotated[str, Meta(min_length=1, max_length=40)]

MOST = 200
"""Waypoints, and steps, in one file."""

LONGEST = 120
"""Of what the user is told by a step [characters]."""

JOINT_SPEED, LINE_SPEED, TOUCH_SPEED = 0.33, 0.25, 0.05
"""Full speed of taught moves: a joint move, as a share of the joints' limits; a line, and a line until contact [m/s]."""

MOVES = {"joint": "Move to", "line": "Line to", "touch": "Touch on the way to"}
OTHERS = {
    "until contact": "Move until contact",
    "wait": "Wait",
    "contact": "Wait for a contact",
    "input": "Wait for an input",
    "output on": "Output on",
    "output off": "Output off",
    "tool on": "Tool on",
    "tool off": "Tool off",
    "zero": "Zero the force sensor",
    "tell": "Tell the user",
}
THEN: dict[str, Literal["contact_pose", "retract", "stop"]] = {"stay": "contact_pose", "retreat": "retract", "go on": "stop"}
"""What follows a contact that ends a move, with what the program calls it."""


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


Do = Literal[
    "joint",
    "line",
    "touch",
    "until contact",
    "wait",
    "contact",
    "input",
    "output on",
    "output off",
    "tool on",
    "tool off",
    "zero",
    "tell",
]


class TaughtStep(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, omit_defaults=True):
    """A step of the program: a move to a waypoint, or what needs none. Files leave out what `do` does not use."""

    do: Do
    to: Name | None = None  # the waypoint
    seconds: Annotated[float, Meta(ge=0.1, le=3600.0)] = 1.0  # of a wait
    number: LineNumber = 0  # of an input or output
    high: bool = True  # the level that is waited for
    frame: Literal["base", "tool"] = "base"  # until contact, from here on
    along: Literal["x", "y", "z", "-x", "-y", "-z"] = "-z"
    distance: Annotated[float, Meta(ge=0.001, le=1.0)] = 0.2  # at most [m]
    speed: Annotated[float, Meta(ge=0.001, le=0.25)] = 0.03  # [m/s]
    then: Literal["stay", "retreat", "go on"] = "stay"
    back: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.05  # of a retreat [m]
    says: Annotated[str, Meta(min_length=1, max_length=LONGEST)] = "Ready"  # what the user is told
    when: InputLevel | None = None  # else it is left out

    def __post_init__(self) -> None:
        """Check that a move to a waypoint, and only that, has one."""
        if (self.to is not None) != (self.do in MOVES):
            raise ValueError(f"to: {self.do!r} {'needs' if self.do in MOVES else 'has no'} waypoint")

    @property
    def text(self) -> str:
        """The step in words."""
        return self._what() + ("" if self.when is None else f" if input {self.when.input} is {level(self.when.high)}")

    def _what(self) -> str:
        if self.to is not None:
            return f"{MOVES[self.do]} {self.to}"
        if self.do == "until contact":
            way = f"{self.frame} {axis(self.along)}"
            back = f" {1000.0 * self.back:g} mm" if self.then == "retreat" else ""
            return f"Until contact, {way}, {1000.0 * self.distance:g} mm, {self.then}{back}"
        if self.do == "wait":
            return f"Wait {self.seconds:g} s"
        if self.do == "input":
            return f"Wait until input {self.number} is {level(self.high)}"
        if self.do in ("output on", "output off"):
            return f"Output {self.number} {self.do.removeprefix('output ')}"
        if self.do == "tell":
            return f"Tell “{self.says}”"
        return OTHERS[self.do]


def axis(along: str) -> str:
    """A direction in a word: "-Z"."""
    return along.upper() if along[0] == "-" else f"+{along.upper()}"


def level(high: bool) -> str:
    """A level in a word."""
    return "high" if high else "low"


class Lesson(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """All that was taught. Until it has steps of its own, the program visits the waypoints in order."""

    waypoints: Annotated[list[Waypoint], Meta(max_length=MOST)] = []
    steps: Annotated[list[TaughtStep], Meta(max_length=MOST)] | None = None
    repeat: Annotated[int, Meta(ge=0, le=MOST_RUNS)] = 1  # times that the program runs; 0: until it is stopped

    def __post_init__(self) -> None:
        """Check that names are unique and known."""
        names = [waypoint.name for waypoint in self.waypoints]
        if len(set(names)) != len(names):
            raise ValueError("waypoints: two have the same name")
        for step in self.steps or []:
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
        if self.steps is not None:
            return self.steps
        return [TaughtStep(do="joint", to=waypoint.name) for waypoint in self.waypoints]

    def free_name(self) -> str:
        """A name that no waypoint has."""
        names = {waypoint.name for waypoint in self.waypoints}
        return next(name for name in (f"P{number}" for number in range(1, MOST + 2)) if name not in names)

    def with_waypoint(self, waypoint: Waypoint) -> "Lesson":
        """With one more waypoint at the end, and a move to it at the end of the program."""
        more = [TaughtStep(do="joint", to=waypoint.name)]
        steps = None if self.steps is None else [*self.steps, *more][:MOST]
        return replace(self, waypoints=[*self.waypoints, waypoint], steps=steps)

    def taught_again(self, name: str, waypoint: Waypoint) -> "Lesson":
        """With another posture for the waypoint `name`."""
        there = replace(waypoint, name=name)
        return replace(self, waypoints=[there if one.name == name else one for one in self.waypoints])

    def without(self, name: str) -> "Lesson":
        """Without a waypoint and the steps that lead to it."""
        steps = None if self.steps is None else [step for step in self.steps if step.to != name]
        return replace(self, waypoints=[one for one in self.waypoints if one.name != name], steps=steps)

    def renamed(self, name: str, new: str) -> "Lesson":
        """With another name for a waypoint."""
        steps = None
        if self.steps is not None:
            steps = [replace(step, to=new) if step.to == name else step for step in self.steps]
        return replace(self, waypoints=[replace(w, name=new) if w.name == name else w for w in self.waypoints], steps=steps)

    def moved(self, name: str, by: int) -> "Lesson":
        """With a waypoint moved up (-1) or down (1) in the list."""
        return replace(self, waypoints=_moved(self.waypoints, self.waypoints.index(self.find(name)), by))

    def with_steps(self, steps: list[TaughtStep]) -> "Lesson":
        """With another program."""
        return replace(self, steps=steps)

    def with_step_moved(self, at: int, by: int) -> "Lesson":
        """With a step moved up (-1) or down (1) in the program, by one place or more."""
        return self.with_steps(_moved(self.plan, at, by))


T = TypeVar("T")


def _moved(items: list[T], at: int, by: int) -> list[T]:
    """A copy in which one item has gone up or down, as far as it can."""
    there = items.copy()
    there.insert(min(max(at + by, 0), len(items) - 1), there.pop(at))
    return there


def program(lesson: Lesson, steps: list[TaughtStep], repeat: int = 1, name: str = "taught") -> Program:
    """The program of some steps, which are done `repeat` times."""
    return Program(name=name, steps=tuple(replace(_move(lesson, step), when=step.when) for step in steps), repeat=repeat)


def _move(lesson: Lesson, step: TaughtStep) -> AnyStep:
    if step.to is not None:
        return _way(lesson.find(step.to), step.do)
    if step.do == "wait":
        return Wait(duration=step.seconds)
    if step.do == "zero":
        return ZeroSensor()
    if step.do == "tell":
        return Tell(text=step.says)
    if step.do == "contact":
        return WaitForContact()
    if step.do == "input":
        return WaitForInput(level=InputLevel(input=step.number, high=step.high))
    if step.do in ("output on", "output off"):
        return SetOutput(output=step.number, on=step.do == "output on")
    if step.do != "until contact":
        return SwitchTool(on=step.do == "tool on")
    until = Until(change="gained", then=THEN[step.then], distance=step.back)
    return ContactMove(frame=step.frame, along=step.along, distance=step.distance, speed=step.speed, until=until)


def _way(target: Waypoint, do: str) -> AnyStep:
    """A move to a waypoint."""
    if do == "joint":
        return JointMove(q=tuple(target.q), speed=JOINT_SPEED, acceleration=0.25)
    x, y, z = target.position
    w, i, j, k = target.quaternion
    touching = do == "touch"
    return LinearMove(
        position=(x, y, z),
        quaternion=(w, i, j, k),
        speed=TOUCH_SPEED if touching else LINE_SPEED,
        acceleration=0.5,
        until=Until(then="retract") if touching else None,
    )
