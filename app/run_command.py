"""`pendant run`: sessions without a window; a file that cannot be used ends no other one."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from app.command_exit import refuse
from app.command_options import AnyFile, Out, Seed, SessionNames, Set, example, setting
from app.ending import ending
from app.files.bad_input import ABSENT, BadInput
from app.session.prepare import prepare
from app.session.session_file import Session, find_all, opened

if TYPE_CHECKING:  # loaded when something runs: the command line must be there at once
    from app.runs.jobs import Job
    from app.runs.runner import RunOutcome

RUN_EXAMPLES = example(
    "pendant run free-drive",
    "pendant run my.yaml --out results --seed 7 --set free_drive.period=5",
    "pendant run sessions/ more.yaml --junit results/junit.xml",
    "pendant run hold --realtime",
)


def run_(
    sessions: SessionNames,
    *,
    out: Out = Path("out"),
    seed: Seed = None,
    realtime: Annotated[bool, typer.Option("--realtime", help="Keep the pace of the clock.")] = False,
    set_: Set = None,
    junit: Annotated[Path | None, typer.Option(help="Write the expectations as JUnit XML.", show_default=False)] = None,
    any_file: AnyFile = False,
) -> None:
    """Run sessions without a window, as fast as they go; several in parallel.

    Exit code 1 when an expectation is not met, 2 when a file cannot be used; the others run all the same.
    """
    from app.runs.jobs import Job, work
    from app.runs.junit import write as write_junit
    from app.runs.progress import progress, show, show_all

    changes = dict(setting(text) for text in set_ or [])
    paths = [path for name in sessions for path in find_all(name)]
    jobs: list[Job] = []
    refused: list[BadInput] = []
    for path in paths:
        try:
            content = opened(path, Session, any_file)
            content = msgspec.structs.replace(
                content, seed=content.seed if seed is None else seed, settings={**content.settings, **changes}
            )
            prepare(content, path.name)
        except BadInput as error:
            refused.append(error)
        else:
            jobs.append(Job(path.name, content, out if len(paths) == 1 else out / path.stem, realtime))
    if len({job.out for job in jobs}) < len(jobs):
        raise BadInput("run", "SESSION", ABSENT, "two files of the same name; their results would overwrite each other")
    if len(paths) == 1 and jobs:
        with ending(interrupts=True), progress(jobs[0].session) as advance:
            found = {paths[0].stem: work(jobs[0], advance)}
        show(jobs[0].session, found[paths[0].stem], out)
    else:
        found = _run_each(jobs, refused) if jobs else {}
        if found:
            show_all([*found], [*found.values()], out)
    for error in refused:
        refuse(str(error))
    if junit is not None:
        write_junit(junit, found, [str(error) for error in refused])
    if refused:
        raise typer.Exit(2)
    if not all(outcome.passed for outcome in found.values()):
        raise typer.Exit(1)


def _run_each(jobs: "list[Job]", refused: list[BadInput]) -> "dict[str, RunOutcome]":
    """What became of each, by the name of its file, in order; what cannot be used goes to `refused`."""
    from app.runs.jobs import run_each
    from app.runs.progress import counting

    outcomes: dict[int, RunOutcome | BadInput] = {}
    with ending(interrupts=True), counting("sessions") as told:
        for place, outcome in run_each(jobs):
            outcomes[place] = outcome
            told(len(outcomes), len(jobs))
    found: dict[str, RunOutcome] = {}
    for place, outcome in sorted(outcomes.items()):
        if isinstance(outcome, BadInput):
            refused.append(outcome)
        else:
            found[Path(jobs[place].name).stem] = outcome
    return found
