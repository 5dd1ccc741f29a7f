"""One motion from its begin to rest, with walls or without: where the true arm was in each tick, and what was told."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.program_folder import ProgramFolder
from app.urscript.running.script_runner import ScriptRunner
from benchmarks.walled.motions import LONGEST, Asked
from pendant.decision import Decision
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.tick.modes import TICK
from pendant.tick.pose import Pose, Vector, flat
from pendant.walls.workspace import ArmPoints, Workspace
from sim.arm.frames import matrix_from_quaternion
from sim.exchange.desk import Wishes
from sim.simulation import Simulation

Array = NDArray[np.float64]

SETTLED = 250  # ticks before anybody asks for anything
RESTS = 150  # ticks after a motion's end
ENDS = frozenset({Kind.PROGRAM_FINISHED, Kind.PROGRAM_FAILED, Kind.JOG_ENDED, Kind.JOG_REFUSED, Kind.PROGRAM_REFUSED})


class Track(NamedTuple):
    """What came of a motion."""

    points: list[ArmPoints]  # of the true arm, after each tick from the first of the motion on
    q: Array  # true angles in the same ticks (m, n) [rad]
    events: list[Event]
    ended: Event | None  # what told its end

    @property
    def way(self) -> float:
        """The furthest that a part came from where it began [m]."""
        begin = self.points[0].places
        return max(float(np.linalg.norm(np.subtract(p, begin[name]))) for each in self.points for name, p in each.places.items())

    def distances(self, space: Workspace) -> Array:
        """Of each area's part in each tick (m, areas) [m]."""
        return np.array([space.distances(each) for each in self.points])


def settled(device: Simulation) -> Simulation:
    """The arm has stood for a while."""
    for _ in range(SETTLED):
        device.tick(Wishes(NOTHING, (), ()))
    return device


def run(device: Simulation, asked: Asked) -> Track:
    """Do what is asked, to its end, and let the arm rest."""
    points: list[ArmPoints] = [true_points(device)]
    angles: list[Array] = [device.plant.q.copy()]
    events: list[Event] = []
    cabinet = Cabinet(lambda: device, device.arm.chain.joints, ProgramFolder())
    runner = ScriptRunner(cabinet)
    if asked.script:
        _tick(device, cabinet, NOTHING, first=True)
        runner.offer(asked.script)
    if asked.program is not None:
        device.tick(Wishes(Inputs(program=asked.program), (), ()))
    ended: Event | None = None
    left, begun = RESTS, 0
    for tick in range(round((LONGEST + 2.0) / TICK)):
        inputs = NOTHING
        if asked.program is not None and tick == 0:
            inputs = Inputs(commands=(Command.START_PROGRAM,))
        elif asked.jog is not None:
            holds = ended is None and tick * TICK < asked.held
            inputs = Inputs(jog=asked.jog if holds else None, jog_released=not holds)
        decision = _tick(device, cabinet, inputs) if asked.script else device.tick(Wishes(inputs, (), ()))
        points.append(true_points(device))
        angles.append(device.plant.q.copy())
        events += decision.events
        begun += any(event.kind in (Kind.PROGRAM_STARTED, Kind.JOG_STARTED) for event in decision.events)
        ended = ended or next((event for event in decision.events if event.kind in ENDS), None)
        left -= ended is not None
        if left == 0:
            break
    runner.stop()
    return Track(points, np.array(angles), events, ended)


def true_points(device: Simulation) -> ArmPoints:
    """Where the true arm is, in B."""
    poses = device.plant.poses()
    foot, elbow, flange = poses[0], poses[1 + device.arm.chain.elbow], poses[-1]
    R_WB, R_WF = matrix_from_quaternion(foot[3:]), matrix_from_quaternion(flange[3:])
    p, R, lever = R_WB.T @ (flange[:3] - foot[:3]), R_WB.T @ R_WF, device.tcp
    gravity = device.dynamics.gravity_B
    tcp = Pose(_vector(p + R @ lever), flat(R @ device.R_FT))
    return ArmPoints(Pose(_vector(p), flat(R)), tcp, _vector(R_WB.T @ (elbow[:3] - foot[:3])), _vector(gravity), load(device))


def load(device: Simulation) -> float:
    """Configured payload and tool [kg]."""
    return device.dynamics.load.mass


def _vector(values: Array) -> Vector:
    x, y, z = values.tolist()
    return x, y, z


def _tick(device: Simulation, cabinet: Cabinet, inputs: Inputs, *, first: bool = False) -> Decision:
    number = 1 if first else device.tick_count + 1
    wishes = Wishes(inputs, (), ()).joined(cabinet.wishes(number, device.snapshot))
    decision = device.tick(wishes)
    cabinet.see(number, decision)
    return decision
