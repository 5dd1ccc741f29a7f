"""Arms and scenarios that the tests of this room share."""

from app.files.library import load_arm
from sim.arm.arm_file import Arm
from sim.arm.scenario import Load, ToolModel

ARMS = ("ur3e", "ur5e", "ur10e", "ur16e")
UR5E = load_arm("ur5e")
PROBE = ToolModel(name="probe", mass=0.3, com=[0.0, 0.0, 0.05], tcp=[0.0, 0.0, 0.12], length=0.12, radius=0.02)
TWO_KG = Load(mass=2.0, com=[0.01, -0.02, 0.07])


def arms() -> list[Arm]:
    """All arms that the product ships."""
    return [load_arm(name) for name in ARMS]
