"""The shape of a border where it lies: signed distance of a point to it, and the direction that leads out (VW-1, VW-2)."""

from pendant.tick.pose import ORIGIN, UNTURNED, Pose, Vector, rotation, turned, turned_back
from pendant.walls.definitions import AnyBorder, Wall


class PlacedShape:
    """A border's shape, with the turn and the offset that its settings give it; anchor, size and reference come with each point.

    Args:
        border: whose shape it is.
    """

    __slots__ = ("_field", "_offset", "_sign", "_turn")

    def __init__(self, border: AnyBorder) -> None:
        self._field = border.shape.field()
        turn = rotation(border.orientation)
        self._turn = None if turn == UNTURNED else turn
        self._offset: Vector = border.offset if isinstance(border, Wall) else ORIGIN
        self._sign = 1.0 if isinstance(border, Wall) or not border.keep_out else -1.0

    def measure(self, local: Vector, anchor: Vector, factor: float, reference: Pose) -> tuple[float, Vector]:
        """Distance to the border [m], negative where the part may be, and its gradient, of length 1, in axes of B.

        Args:
            local: the part in the border's reference [m].
            anchor: of the shape, in the reference [m].
            factor: on the shape's lengths and its offset.
            reference: pose X_BR.
        """
        x, y, z = local
        ax, ay, az = anchor
        ox, oy, oz = self._offset
        x, y, z = (x - ax) / factor - ox, (y - ay) / factor - oy, (z - az) / factor - oz
        turn = self._turn
        if turn is not None:
            x, y, z = turned_back(turn, (x, y, z))
        distance, gx, gy, gz = self._field(x, y, z)
        sign = self._sign
        outward = (sign * gx, sign * gy, sign * gz)
        if turn is not None:
            outward = turned(turn, outward)
        if reference.R is not UNTURNED:
            outward = turned(reference.R, outward)
        return sign * factor * distance, outward
