"""`pendant run`: sessions without a window; a file that cannot be used ends no other one."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from app.commands.command_exit import refuse
from app.commands.command_options import AnyFile, Out, Seed, Seeds, SessionNames, Set, example, setting
from app.ending import ending
from app.files.bad_input import ABSENT, BadInput
from app.files.extras import there, to_install
from app.session.prepare import prepare
from app.session.session_file import Session, find_all, opened

if TYPE_CHECKING:  # loaded when something runs: the command line must be there at once
    from app.runs.jobs import Job
    from app.runs.runner import RunOutcome

RUN_EXAMPLES = example(
    "pendant run free-drive",
    "pendant run my.yaml --out results --seed 7 --set free_drive.period=5",
    "pendant run sessions/ more.yaml --junit results/junit.xml",
    "pendant run free-drive my.yaml --seeds 1-12",
    "pendant run hold --realtime",
)


def run_(
    sessions: SessionNames,
    *,
    out: Out = Path("out"),
    seed: Seed = None,
    seeds: Seeds = None,
    realtime: Annotated[bool, typer.Option("--realtime", help="Keep the pace of the clock.")] = False,
    set_: Set = None,
    junit: Annotated[Path | None, typer.Option(help="Write the expectations as JUnit XML.", show_default=False)] = None,
    any_file: AnyFile = False,
) -> None:
    """Run sessions without a window, as fast as they go; several in parallel.

    Exit code 1 when an expectation is not met, 2 when a file cannot be used; the others run all the same.
    """
    from app.report.files import DRAWS
    from app.runs.jobs import Job, work
    from app.runs.junit import write as write_junit
    from app.runs.progress import progress, show, show_all
    from app.runs.seed_runs import seeds_in

    if seed is not None and seeds is not None:
        raise BadInput("run", "--seed", seed, "either --seed or --seeds")
    chosen = None if seeds is None else seeds_in(seeds)
    changes = dict(setting(text) for text in set_ or [])
    paths = [path for name in sessions for path in find_all(name)]
    usable, refused = _checked(paths, changes, seed, any_file)
    jobs = [Job(path.name, content, out if len(paths) == 1 else out / path.stem, realtime) for path, content in usable]
    if len({job.out for job in jobs}) < len(jobs):
        raise BadInput("run", "SESSION", ABSENT, "two files of the same name; their results would overwrite each other")
    if chosen is not None:
        found = _run_seeds(jobs, chosen, refused, out)
    elif len(paths) == 1 and jobs:
        with ending(interrupts=True), progress(jobs[0].session) as advance:
            found = {paths[0].stem: work(jobs[0], advance)}
        show(jobs[0].session, found[paths[0].stem], out)
    else:
        found = {_stem(job): outcome for job, outcome in _run_each(jobs, refused)}
        if found:
            show_all([*found], [*found.values()], out)
    for error in refused:
        refuse(str(error))
    if found and chosen is None and not there(DRAWS):
        typer.echo(f"There is no report.html: that {to_install(DRAWS)}")
    if junit is not None:
        write_junit(junit, found, [str(error) for error in refused])
    if refused:
        raise typer.Exit(2)
    if not all(outcome.passed for outcome in found.values()):
        raise typer.Exit(1)


def _stem(job: "Job") -> str:
    """The name of a job's file without its ending."""
    return Path(job.name).stem


def _checked(
    paths: list[Path], changes: dict[str, float | bool | str], seed: int | None, any_file: bool
) -> tuple[list[tuple[Path, Session]], list[BadInput]]:
    """The sessions that can be used, with `changes` in their settings and `seed` as theirs; and what is said of the others."""
    usable: list[tuple[Path, Session]] = []
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
            usable.append((path, content))
    return usable, refused


def _run_seeds(jobs: "list[Job]", seeds: list[int], refused: list[BadInput], out: Path) -> "dict[str, RunOutcome]":
    """Run each job at each seed, its events into a folder a seed; shows what became of them, and gives it by session and seed."""
    from app.runs.progress import show_seeds
    from app.runs.seed_runs import gathered

    each = [
        job._replace(
            session=msgspec.structs.replace(job.session, seed=seed), out=job.out and job.out / f"seed-{seed}", recorded=False
        )
        for job in jobs
        for seed in seeds
    ]
    done = [(_stem(job), job.session.seed, outcome) for job, outcome in _run_each(each, refused)]
    if done:
        show_seeds(gathered(done), out)
    return {f"{name} at seed {seed}": outcome for name, seed, outcome in done}


def _run_each(jobs: "list[Job]", refused: list[BadInput]) -> "list[tuple[Job, RunOutcome]]":
    """What became of each, in order; what cannot be used goes to `refused`."""
    from app.runs.jobs import run_each
    from app.runs.progress import counting

    if not jobs:
        return []
    outcomes: dict[int, RunOutcome | BadInput] = {}
    with ending(interrupts=True), counting("runs") as told:
        for place, outcome in run_each(jobs):
            outcomes[place] = outcome
            told(len(outcomes), len(jobs))
    found: list[tuple[Job, RunOutcome]] = []
    for place, outcome in sorted(outcomes.items()):
        if isinstance(outcome, BadInput):
            refused.append(outcome)
        else:
            found.append((jobs[place], outcome))
    return found
