"""Joint sensors that fail one by one: what is lost, and what the control goes on with (AF-2, AF-3)."""

from collections.abc import Sequence

from pendant.events.event import Event, Kind
from pendant.tick.estimate import Estimate

NAMES = {"motor_encoder": "motor encoder", "output_encoder": "output encoder", "current": "current sensor"}
LEFT = {
    "motor_encoder": "Nothing is left to move it with",
    "output_encoder": "Its angle comes from the motor, its torque from model and motor",
    "current": "Its friction is not learned, its torque comes from model and deflection",
}


class JointSensors:
    """Notices joint sensors that go and come back."""

    __slots__ = ("lost",)

    def __init__(self) -> None:
        self.lost: tuple[tuple[str, int], ...] = ()

    def step(self, estimate: Estimate, joints: Sequence[str]) -> list[Event]:
        """One tick; `joints` are the names of the joints."""
        if estimate.lost == self.lost:
            return []
        before, self.lost = self.lost, estimate.lost
        events: list[Event] = []
        for sensor, joint in self.lost:
            if (sensor, joint) not in before:
                values = {"sensor": NAMES[sensor], "joint": joints[joint], "left": LEFT[sensor]}
                events.append(Event(Kind.JOINT_SENSOR_LOST, estimate.tick, {**values}))
        for sensor, joint in before:
            if (sensor, joint) not in self.lost:
                events.append(Event(Kind.JOINT_SENSOR_BACK, estimate.tick, {"sensor": NAMES[sensor], "joint": joints[joint]}))
        return events
