"""The world model: frames with names, each at a pose in another one (URScript manual, module world model)."""

from collections.abc import Callable, Iterator

from app.urscript.calculation import pose_algebra as algebra
from app.urscript.language.trouble import Misuse
from app.urscript.machine.signature import Builtin, Taken, builtin, pose, text
from app.urscript.machine.values import PoseValue, Value

HERE = PoseValue((0.0,) * 6)

WORLD, BASE, FLANGE, TCP = "world", "base", "flange", "tcp"

OWN = frozenset({WORLD, BASE, FLANGE, TCP})
"""Frames that there always are. The base stands at the origin of the world."""

MOST_FRAMES = 500
MOST_NAME = 64


class WorldModel:
    """Frames that programs have added; they are forgotten with the robot's start.

    Args:
        flange: tells its pose in the base.
        tcp: tells the tool centre point's pose in the base.
    """

    def __init__(self, flange: Callable[[], PoseValue], tcp: Callable[[], PoseValue]) -> None:
        self._flange, self._tcp = flange, tcp
        self._frames: dict[str, tuple[str, PoseValue]] = {}  # parent, and pose in it

    def known(self, name: str) -> bool:
        """There is a frame of this name."""
        return name in OWN or name in self._frames

    def at(self, name: str) -> PoseValue:
        """Pose in the base. Raises Misuse: there is no such frame."""
        place = HERE
        while name in self._frames:
            parent, inside = self._frames[name]
            place, name = algebra.transformed(inside, place), parent
        return algebra.transformed(self._own(name), place)

    def _own(self, name: str) -> PoseValue:
        if name not in OWN:
            raise Misuse(f"there is no frame {name[:MOST_NAME]!r}")
        return HERE if name in (WORLD, BASE) else self._flange() if name == FLANGE else self._tcp()

    def add(self, name: str, inside: PoseValue, reference: str) -> None:
        """Add a frame. Raises Misuse: its name is taken, or the reference is not there."""
        if self.known(name) or not 0 < len(name) <= MOST_NAME:
            raise Misuse(f"name: {name[:MOST_NAME]!r} is taken, empty or longer than {MOST_NAME} characters")
        if len(self._frames) == MOST_FRAMES:
            raise Misuse(f"more than {MOST_FRAMES} frames")
        self.at(reference)
        self._frames[name] = reference, inside

    def move(self, name: str, inside: PoseValue, reference: str) -> None:
        """Place a frame anew; it stays attached to what it was attached to."""
        parent, _ = self._added(name)
        place = algebra.transformed(self.at(reference), inside)
        self._frames[name] = parent, algebra.transformed(algebra.inverted(self.at(parent)), place)

    def attach(self, child: str, parent: str) -> None:
        """Have a frame go with another one from now on, from where it is. Raises Misuse: that one goes with it."""
        self._added(child)
        above = parent
        while above in self._frames:
            if above == child:
                raise Misuse(f"parent: {parent} goes with {child} already")
            above = self._frames[above][0]
        self._frames[child] = parent, algebra.transformed(algebra.inverted(self.at(parent)), self.at(child))

    def delete(self, name: str) -> None:
        """Delete a frame. Raises Misuse: others go with it."""
        self._added(name)
        below = self.children(name)
        if below:
            raise Misuse(f"name: {', '.join(below)[:MOST_NAME]} goes with {name}")
        del self._frames[name]

    def delete_all(self) -> None:
        """Delete all frames that were added."""
        self._frames.clear()

    def parent(self, name: str) -> str:
        """What a frame goes with."""
        if name in self._frames:
            return self._frames[name][0]
        self._own(name)
        return {BASE: WORLD, FLANGE: BASE, TCP: FLANGE}.get(name, "")

    def children(self, name: str) -> tuple[str, ...]:
        """Frames that go with one."""
        self.at(name)
        return tuple(each for each in (*sorted(OWN), *self._frames) if self.parent(each) == name)

    def relative(self, name: str, origin: str, axes: str) -> PoseValue:
        """Pose of a frame from the origin of another one, in the axes of a third one."""
        inside = algebra.transformed(algebra.inverted(self.at(origin)), self.at(name))
        if axes in ("", origin):
            return inside
        turned = PoseValue((0.0, 0.0, 0.0, *algebra.transformed(algebra.inverted(self.at(axes)), self.at(origin))[3:]))
        return algebra.transformed(turned, inside)

    def _added(self, name: str) -> tuple[str, PoseValue]:
        if name not in self._frames:
            raise Misuse(f"name: there is no frame {name[:MOST_NAME]!r} that was added")
        return self._frames[name]


def of_frames(world: WorldModel) -> Iterator[Builtin]:
    """All of them."""
    name, inside, reference = Taken("name", text), Taken("pose", pose), Taken("ref_name", text, BASE)

    def convert(x: PoseValue, source: str, target: str) -> Value:
        return algebra.transformed(algebra.transformed(algebra.inverted(world.at(target)), world.at(source)), x)

    yield builtin("add_frame", world.add, name, inside, reference)
    yield builtin("move_frame", world.move, name, inside, reference)
    yield builtin("attach_frame", world.attach, Taken("child", text), Taken("parent", text))
    yield builtin("delete_frame", world.delete, name)
    yield builtin("delete_all_frames", world.delete_all)
    yield builtin("reset_world_model", world.delete_all)
    yield builtin("is_frame", world.known, name)
    yield builtin("get_frame_parent", world.parent, name)
    yield builtin("get_children", world.children, name)
    yield builtin("get_pose", world.relative, name, Taken("rel_name", text, BASE), Taken("ref_name", text, ""))
    yield builtin("convert_pose", convert, inside, Taken("from_frame", text), Taken("to_frame", text))
