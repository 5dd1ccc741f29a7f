"""What `pendant_sim` gives: a session, a simulation stepped by hand, a study, a recording read into numpy.

`read(path)` gives an `app.log_reading.reader.Log`. Errors are `BadInput`, whose text is one line: file, field, value, what is
allowed.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from app.files.checked import convert
from app.log_reading.reader import Log
from app.log_reading.reader import read as read_log
from app.runs.jobs import Job, run_all, work
from app.runs.runner import RunOutcome, simulate
from app.session.prepare import prepare
from app.session.session_file import Session, find, opened
from pendant.inputs import Button, Command, Inputs
from sim.exchange.desk import Wishes
from sim.plant.touch import Touch
from sim.simulation import Simulation

if TYPE_CHECKING:
    from app.studies.sweep import Swept


def session(source: str | Path | dict[str, Any] | Session, **fields: Any) -> Session:
    """A session from a file, the name of a bundled one, another session, or its fields; `fields` replace those of the source.

    Raises:
        BadInput: the source is not there, or does not make a session.
    """
    if isinstance(source, Session):
        raw = msgspec.to_builtins(source)
    else:
        raw = source if isinstance(source, dict) else msgspec.to_builtins(opened(find(str(source)), Session))
    made = convert({**raw, **fields}, Session, "session")
    prepare(made, "session")
    return made


def read(path: str | Path, begin: float | None = None, end: float | None = None) -> Log:
    """A recording, as numpy arrays by name; what is in it is read when it is asked for.

    Args:
        path: of its file; of a recording in parts, of its folder.
        begin: time from which on [s]; None: from the beginning.
        end: time before which [s]; None: to the end.

    Raises:
        BadInput: it cannot be read, or is no recording. What is damaged within raises the same when it is asked for.
    """
    return read_log(Path(path), begin, end)


def run(what: str | Path | dict[str, Any] | Session, out: str | Path | None = None) -> RunOutcome:
    """Run a session as fast as it goes.

    Args:
        what: as `session` takes it.
        out: folder for events.jsonl, log.mcap, summary.json and report.html; None: nothing is kept.

    Raises:
        BadInput: the session cannot be used, or the results cannot be written.
    """
    return work(Job("session", session(what), None if out is None else Path(out)))


def run_many(sessions: Iterable[Session]) -> list[RunOutcome]:
    """Run sessions in parallel on all cores, keeping no files; the outcomes are in the order of the sessions.

    In a script, call it under `if __name__ == "__main__":`, since the other processes import the script.
    """
    found = dict(run_all(Job("session", each, None) for each in sessions))
    return [found[k] for k in range(len(found))]


def sweep(study: str | Path, out: str | Path, *, quick: bool = False, seed: int | None = None) -> "Swept":
    """Run a study on all cores, as `pendant sweep` does; it goes on where it stopped.

    In a script, call it under `if __name__ == "__main__":`, since the other processes import the script.

    Args:
        study: a study file, or the name of a bundled study.
        out: folder for rows/ and report.html.
        quick: the small size that the study names.
        seed: of its first run; None: the study's own.

    Raises:
        BadInput: the study does not make sense, or `out` holds another one.
    """
    from app.studies.study_file import open_study
    from app.studies.sweep import sweep as swept

    content, base = open_study(str(study), quick=quick, seed=seed)
    return swept(content, base, Path(out), where=Path(study).name)


def stepped(what: Session) -> Simulation:
    """The simulation of a session's header, at its start; its time line does not act. `step` does its ticks."""
    return simulate(prepare(what, "session"))


def step(
    simulation: Simulation,
    ticks: int = 1,
    *,
    held: Iterable[Button] = (),
    commands: Iterable[Command] = (),
    touches: Iterable[Touch] = (),
) -> None:
    """Do ticks of 2 ms; then read `simulation.estimate`, `simulation.plant` or `simulation.snapshot()`.

    Args:
        simulation: from `stepped`.
        ticks: how many.
        held: buttons held all the time.
        commands: given in the first of them.
        touches: what hands do all the time; a `Push` is a force in W [N] on a point of a part, a `Pull` a hand that holds it.

    Raises:
        KeyError: a touch names a part that does not exist.
    """
    held, touches, first = frozenset(held), tuple(touches), tuple(commands)
    for k in range(ticks):
        simulation.tick(Wishes(Inputs(held=held, commands=first if k == 0 else ()), touches, ()))
