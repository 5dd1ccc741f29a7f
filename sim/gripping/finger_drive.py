"""The drive of a gripper: how wide the fingers stand, where they go, and how hard they press (GR-3)."""

from dataclasses import dataclass
from typing import NamedTuple

from sim.arm.scenario import Cup, Fingers


class GripperState(NamedTuple):
    """A gripper as it is; what its own electronics tell. A cup is closed while it draws, and has no width."""

    closing: bool  # it closes, or is closed
    moving: bool
    held: str  # name of the part, "" for none
    met: bool  # a part keeps the fingers from where they are to go
    opening: float = 0.0  # distance of the pads [m]
    wanted: float = 0.0  # distance that they go to [m]
    stroke: float = 0.0  # largest distance [m]
    force: float = 0.0  # of one finger, or of the vacuum [N]
    taken: float = 0.0  # share of the grip's strength that the load takes


@dataclass(slots=True)
class FingerDrive:
    """Fingers between 0 and their stroke; they begin open. Of a cup nothing but whether it draws counts.

    Attributes:
        opening: distance of the pads [m].
        wanted: distance that they go to [m].
        speed: of one pad against the other [m/s].
        force: of one finger [N].
        closing: the last order was to close.
    """

    fingers: Fingers
    opening: float = 0.0
    wanted: float = 0.0
    speed: float = 0.0
    force: float = 0.0
    closing: bool = False

    def __post_init__(self) -> None:
        """Begin open, at the most that the drive can."""
        own = self.fingers
        self.opening = self.wanted = own.stroke
        self.speed, self.force = own.most_speed, own.most_force

    def order(self, opening: float | None, speed: float | None, force: float | None) -> None:
        """Go to a distance, at a speed, with a force; None: as before. What is beyond the drive's range is its limit."""
        own = self.fingers
        if opening is not None:
            self.wanted = min(max(opening, 0.0), own.stroke)
            self.closing = self.wanted < self.opening or self.wanted == 0.0
        if speed is not None:
            self.speed = min(max(speed, own.least_speed), own.most_speed)
        if force is not None:
            self.force = min(max(force, own.least_force), own.most_force)

    def stop(self) -> None:
        """Stay where it is."""
        self.wanted = self.opening

    @property
    def moving(self) -> bool:
        """On the way."""
        return self.opening != self.wanted

    def step(self, span: float) -> None:
        """Go on for `span` [s]."""
        way = self.speed * span
        if self.wanted > self.opening:
            self.opening = min(self.opening + way, self.wanted)
        else:
            self.opening = max(self.opening - way, self.wanted)


def vacuum_force(cup: Cup) -> float:
    """What the air presses a part on with: p pi r² [N]."""
    return cup.vacuum * 3.141592653589793 * cup.radius**2
