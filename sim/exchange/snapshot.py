"""What a picture or a log of one tick needs: copied values, safe to read from any thread."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from pendant.decision import Decision
from pendant.guided.pull import PullCauses
from pendant.tick.estimate import Estimate
from pendant.walls.barrier import Place
from pendant.walls.definitions import AnyBorder
from sim.arm.frames import rotation_from_rpy
from sim.arm.scenario import Scenario
from sim.exchange.told_force import UncertainForce
from sim.gripping.finger_drive import GripperState


def _nothing() -> NDArray[np.float64]:
    return np.zeros(0)


@dataclass(frozen=True, slots=True)
class Snapshot:
    """One tick, copied. Poses are (7,): position [m], then quaternion wxyz, in W."""

    tick: int
    decision: Decision
    estimate: Estimate  # a copy of its own
    truth_links: NDArray[np.float64]  # (n + 2, 7) base, links' joint frames, last: tool-side face of the flange sensor
    truth_objects: NDArray[np.float64]  # (m, 7) world objects, in the scenario's order
    truth_payload: NDArray[np.float64] | None  # (7,) pose of the payload's centre; falls and rests once dropped
    truth_payload_mass: float  # of what is attached [kg]
    configured_mass: float  # what the controller believes [kg]
    touches: tuple[tuple[str, tuple[float, ...], tuple[float, ...], tuple[float, ...]], ...]
    # each: part, point in W [m], force in W [N], torque in W [N·m]
    wanted_q: NDArray[np.float64] = field(
        default_factory=_nothing
    )  # (n,) reference of the tracking laws [rad]; none in free-drive
    truth_q: NDArray[np.float64] = field(default_factory=_nothing)  # (n,) output angles [rad]
    truth_friction: NDArray[np.float64] = field(default_factory=_nothing)  # (n,) of both sides, with the speed's sign [N·m]
    truth_tau_J: NDArray[np.float64] = field(default_factory=_nothing)  # (n,) transmission torque [N·m]
    truth_temperature: NDArray[np.float64] = field(default_factory=_nothing)  # (n,) of the joints [°C]
    truth_touched: bool = False  # a hand or an object touches the arm, or what it carries
    scenario: Scenario | None = None  # what the simulation started from; the same object for all of its ticks
    reference: NDArray[np.float64] | None = None  # (n,) where the joints should be; None in free-drive [rad]
    places: tuple[tuple[AnyBorder, Place], ...] = ()  # walls and areas with where their shapes lie in B
    pull: PullCauses | None = None  # what pulls at the free arm: of the last 0.1 s the tick in which that is least a hand (FD-19)
    user: UncertainForce | None = None  # what is taken for the user's force (FD-19); None while the arm is not free
    gripper: GripperState | None = None  # of the tool that is mounted; None: it has none, or it is not recorded

    @property
    def p_FT(self) -> NDArray[np.float64]:
        """(3,) The centre point of the tool in use, in F [m]; the flange's own where none is fitted."""
        fitting = self.decision.estimator.fitting
        return np.zeros(3) if fitting is None else np.array(fitting.tool.tcp)

    @property
    def R_FT(self) -> NDArray[np.float64]:
        """(3, 3) How the tool in use is turned in F; not at all where none is fitted."""
        fitting = self.decision.estimator.fitting
        return np.eye(3) if fitting is None else rotation_from_rpy(fitting.tool.rpy)
