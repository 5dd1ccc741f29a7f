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
    from app.api import (
        BadInput,
        Button,
        Command,
        Log,
        Pull,
        Push,
        RunOutcome,
        Session,
        Simulation,
        read,
        run,
        run_many,
        session,
        step,
        stepped,
        sweep,
    )
    from app.files.library import load_arm
    from app.served_robot import ServedRobot as Robot

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

ELSEWHERE = {"Robot": ("app.served_robot", "ServedRobot"), "load_arm": ("app.files.library", "load_arm")}
"""Module and name of what is not in app.api."""


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from pendant_sim.ours import hidden

    trouble = hidden()
    if trouble is not None:
        raise ImportError(trouble)
    module, its_name = ELSEWHERE.get(name, ("app.api", name))
    return getattr(import_module(module), its_name)
