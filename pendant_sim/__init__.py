"""A teach pendant and the cobot behind it, simulated: the product from Python.

    from pendant_sim import run, session

    outcome = run(session("hold", seed=7))

Names:
    session, run, run_many, sweep: a session from a file, a bundled name or its fields; run it, many, or a study of it.
    stepped, step, Simulation: a simulation stepped by hand, with `Push`, `Pull`, `Button` and `Command`.
    read, Log: a recording as numpy arrays.
    Robot: a robot on this machine's network, as clients of UR robots know it; the fixture `robot` of pytest gives one to a test.
    load_arm: the numbers of an arm.
    BadInput: the error of each; its text is one line: file, field, value, what is allowed.

Nothing of the product is imported before a name is used.

Raises:
    ImportError: another folder hides one of the product's; it says which.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from app.api import read, run, run_many, session, step, stepped, sweep
    from app.files.bad_input import BadInput
    from app.files.library import load_arm
    from app.log_reading.reader import Log
    from app.runs.runner import RunOutcome
    from app.served_robot import ServedRobot as Robot
    from app.session.session_file import Session
    from pendant.inputs import Button, Command
    from sim.plant.touch import Pull, Push
    from sim.simulation import Simulation

__all__ = [
    "BadInput",
    "Button",
    "Command",
    "Log",
    "Pull",
    "Push",
    "Robot",
    "RunOutcome",
    "Session",
    "Simulation",
    "load_arm",
    "read",
    "run",
    "run_many",
    "session",
    "step",
    "stepped",
    "sweep",
]

ELSEWHERE = {
    "BadInput": "app.files.bad_input",
    "Button": "pendant.inputs",
    "Command": "pendant.inputs",
    "Log": "app.log_reading.reader",
    "Pull": "sim.plant.touch",
    "Push": "sim.plant.touch",
    "RunOutcome": "app.runs.runner",
    "ServedRobot": "app.served_robot",
    "Session": "app.session.session_file",
    "Simulation": "sim.simulation",
    "load_arm": "app.files.library",
}
"""Module of each name that is not in app.api."""


def defined(name: str) -> tuple[str, str]:
    """Module in which a name of `__all__` is defined, and its name there."""
    its_name = "ServedRobot" if name == "Robot" else name
    return ELSEWHERE.get(its_name, "app.api"), its_name


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from pendant_sim.ours import hidden

    trouble = hidden()
    if trouble is not None:
        raise ImportError(trouble)
    module, its_name = defined(name)
    return getattr(import_module(module), its_name)
