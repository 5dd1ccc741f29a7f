"""Compiles all kernels before anybody waits for them: a fresh installation compiles here, later starts only load."""

import os
from contextlib import suppress
from pathlib import Path

import msgspec
import numpy as np

from app.files.checked import load
from app.files.library import ASSETS
from app.log.recorder import Recorder
from app.runs.runner import run, simulate
from app.session.prepare import prepare
from app.session.session_file import Session
from app.session.timeline_checks import Prepared
from app.urscript.language.reading import read_script
from pendant.motion.script_requests import DirectTorque, SpeedTool
from pendant.program.steps import JointMove, LinearMove, Program
from sim.arm.arm_file import Arm
from sim.arm.frames import joint_frames, quaternion_from_matrix
from sim.motion.moves import Reference
from sim.motion.pace import Pace
from sim.motion.streams import ToolStream
from sim.paths.timing_law import MoveRefused
from sim.paths.tool_point import ToolPoint
from sim.simulation import Simulation


def warm_up(arm: Arm | None = None) -> None:
    """Run everything that a tick may do, without a page: half a minute in a fresh installation, a second later on.

    A kernel that is compiled at its first use would stop the arm for seconds, in the middle of a user's first free-drive. Kernels
    are compiled for a number of joints. So an `arm` with another number than the session's arm runs the session itself.
    """
    session = load(ASSETS / "warm-up.yaml", Session)
    prepared = prepare(session, "warm-up")
    if arm is not None and arm.n != prepared.arm.n:
        prepared = _on(arm, prepared)
    simulation = simulate(prepared)
    with Recorder(Path(os.devnull), simulation, session.title) as recorder:
        run(session, prepared, simulation, None, see=lambda decision: recorder.see(simulation, decision))
    simulation.snapshot()
    _stream(simulation)
    # No step of a session uses direct_torque.
    none = (0.0,) * simulation.arm.n
    torque = DirectTorque(id=0, torque=none, viscous=none, coulomb=none)
    simulation.controller.feed_forward.commanded(torque, simulation.estimate, simulation.estimator.friction)
    read_script("")


def _on(arm: Arm, prepared: Prepared) -> Prepared:
    """The same with another arm. Its program moves a joint by 0.01 rad, and the tool by 1 cm, from the arm's home."""
    home = arm.chain.home
    place = joint_frames(arm, home)[-1]
    x, y, z = place[:3, 3].tolist()
    w, i, j, k = quaternion_from_matrix(place[:3, :3]).tolist()
    joints = JointMove(q=(home[0] + 0.01, *home[1:]), speed=0.2, acceleration=0.5)
    line = LinearMove(position=(x, y, z - 0.01), quaternion=(w, i, j, k), speed=0.1, acceleration=0.5)
    scenario = msgspec.structs.replace(prepared.scenario, posture=home)
    return prepared._replace(arm=arm, scenario=scenario, program=Program(name="a centimetre", steps=(joints, line)))


def _stream(simulation: Simulation) -> None:
    """A tick of a streamed command."""
    limits, dynamics, tcp, q = simulation.arm.limits, simulation.dynamics, simulation.tcp, simulation.estimate.q
    most = np.array(limits.speed), np.array(limits.acceleration), np.array(limits.ends).T.copy()
    now, up = Reference(q, np.zeros_like(q), np.zeros_like(q)), (0.0, 0.0, 0.01)
    move = SpeedTool(id=0, speed=up, turning=(0.0, 0.0, 0.0), acceleration=0.1, turning_acceleration=0.1)
    tool, pace = ToolPoint(dynamics, tcp), Pace(simulation.controller.references.meter)
    with suppress(MoveRefused):  # an arm of fewer than six joints moves no tool, and is singular everywhere
        ToolStream(now, move, tool, R_FT=simulation.R_FT, limits=most, pace=pace).step(1.0, None)
