"""How a wall resists: in the feedback band before it (VW-7) and beyond it (VW-10). It never pulls outwards.

In the band the resistance opposes motion towards the wall alone: its power is never positive, so that whatever a hand does, the
wall takes energy from it and gives none. Beyond the border a spring and a damper hold the part at the innermost place that it
has been at since it went out: motion further out meets them, the way back is free.
"""


def closeness(distance: float, band: float) -> float:
    """0 at the inner edge of the band and before it, 1 at the wall and beyond.

    Args:
        distance: to the wall, negative inside [m].
        band: width of the band [m].
    """
    if distance >= 0.0:
        return 1.0
    return max(1.0 + distance / band, 0.0) if band > 0.0 else 0.0


def resisting(near: float, speed: float, damping: float) -> float:
    """Size of the resisting force [N]; 0 unless the part moves towards the wall.

    The user's push is not answered in kind: a force that took it away as soon as the part moves would have a slope of thousands
    of N·s/m, and so much damping, two ticks late, chatters on a part of a few kilograms and gives it energy.

    Args:
        near: `closeness`.
        speed: of the part, towards the wall [m/s].
        damping: at the wall [N·s/m].
    """
    if near <= 0.0 or speed <= 0.0:
        return 0.0
    return near * damping * speed


class LimitGuard:
    """Remembers how far out a part may be: further out is resisted, and the place itself moves only inwards (VW-10).

    A part that starts outside starts at this place, so that nothing pushes it.
    """

    __slots__ = ("place", "started_outside")

    def __init__(self, distance: float) -> None:
        self.place = max(distance, 0.0)  # distance beyond the wall [m]
        self.started_outside = self.place > 0.0

    def step(self, distance: float, drift: float) -> float:
        """How far the part is beyond its place [m], negative or 0 unless it is.

        Args:
            distance: to the wall [m].
            drift: how far the wall moved inwards past the part in this tick, by itself [m]; a wall pushes no part.
        """
        if drift > 0.0 and distance > 0.0:
            self.place += drift
        if distance < self.place:
            self.place = max(distance, 0.0)
            if distance <= 0.0:
                self.started_outside = False
        return distance - self.place

    def resisting(self, beyond: float, speed: float, stiffness: float, damping: float) -> float:
        """Size of the force on a part `beyond` its place [N]: spring and damper, which never pull it outwards."""
        spring = stiffness * beyond if beyond > 0.0 else 0.0
        return max(spring + damping * speed, 0.0)
