"""All walls and areas together, from the activation period to leaving (VW-6)."""

from pendant.walls.barrier import Around, Barrier, Consequence, Place, Reading, Stage
from pendant.walls.definitions import AnyBorder, Start, Wall


class Enclosure:
    """The walls and areas of one arm. Nothing holds before `begin` and after `leave`.

    Args:
        borders: their settings; `pendant.walls.definitions.problem` has found nothing.
    """

    __slots__ = ("_barriers", "_borders")

    def __init__(self, borders: tuple[AnyBorder, ...]) -> None:
        self._borders = borders
        self._barriers: list[Barrier] = []

    def begin(self, start: Start) -> None:
        """The activation period begins, or the sequence: the activation shapes that are to be anchored then hold from now on."""
        if start is Start.ACTIVATION:
            self._barriers = []
        self._barriers += [Barrier(border, Stage.ACTIVATION) for border in self._borders if _start(border) is start]

    def enter(self) -> None:
        """FREE_DRIVE begins: the operation shapes hold, anchored in the next step."""
        self._barriers = [Barrier(border, Stage.OPERATION) for border in self._borders]

    def leave(self) -> None:
        """Refused, cancelled, or left: nothing holds."""
        self._barriers = []

    def step(self, around: Around) -> tuple[Reading, ...]:
        """One tick: every wall that holds."""
        return tuple([barrier.step(around) for barrier in self._barriers])

    def places(self) -> tuple[Place | None, ...]:
        """Where their shapes lie, in the order of the readings; None for one that has not been anchored yet."""
        return tuple(barrier.place() for barrier in self._barriers)


def worst(readings: tuple[Reading, ...]) -> Reading | None:
    """The reading with the gravest consequence, among equals the first of those furthest out; None when nothing follows."""
    gravest = None
    for reading in readings:
        consequence = reading.consequence
        if consequence is _NONE:
            continue
        if gravest is None or (consequence, reading.distance) > (gravest.consequence, gravest.distance):
            gravest = reading
    return gravest


def _start(border: AnyBorder) -> Start:
    return border.anchored_at if isinstance(border, Wall) else Start.SEQUENCE


_NONE = Consequence.NONE  # looked up in every tick
