"""Makes ready what is compiled before anybody waits for it: a fresh installation compiles here, later starts only load."""

import os
from pathlib import Path

import numpy as np

from app.files.checked import load
from app.files.library import ASSETS
from app.log.recorder import Recorder
from app.runs.runner import run, simulate
from app.session.prepare import prepare
from app.session.session_file import Session
from app.urscript.language.reading import read_script
from pendant.motion.script_requests import DirectTorque, SpeedTool
from sim.motion.moves import Reference
from sim.motion.pace import Pace
from sim.motion.streams import ToolStream
from sim.paths.tool_point import ToolPoint
from sim.simulation import Simulation


def warm_up() -> None:
    """Go through all that a tick may do, without a page: half a minute in a fresh installation, a second later on.

    A kernel that is compiled at its first use would stop the arm for seconds, in the middle of a user's first free-drive.
    """
    session = load(ASSETS / "warm-up.yaml", Session)
    prepared = prepare(session, "warm-up")
    simulation = simulate(prepared)
    with Recorder(Path(os.devnull), simulation, session.title) as recorder:
        run(session, prepared, simulation, None, see=lambda decision: recorder.see(simulation, decision))
    simulation.snapshot()
    _stream(simulation)
    # What no session's step does: direct_torque.
    none = (0.0,) * simulation.arm.n
    torque = DirectTorque(id=0, torque=none, viscous=none, coulomb=none)
    simulation.controller.feed_forward.commanded(torque, simulation.estimate, simulation.estimator.friction)
    read_script("")


def _stream(simulation: Simulation) -> None:
    """A tick of a command that comes again and again."""
    limits, dynamics, tcp, q = simulation.arm.limits, simulation.dynamics, simulation.tcp, simulation.estimate.q
    most = np.array(limits.speed), np.array(limits.acceleration), np.array(limits.ends).T.copy()
    now, up = Reference(q, np.zeros_like(q), np.zeros_like(q)), (0.0, 0.0, 0.01)
    move = SpeedTool(id=0, speed=up, turning=(0.0, 0.0, 0.0), acceleration=0.1, turning_acceleration=0.1)
    tool, pace = ToolPoint(dynamics, tcp), Pace(simulation.controller.references.meter)
    ToolStream(now, move, tool, R_FT=simulation.R_FT, limits=most, pace=pace).step(1.0, None)
