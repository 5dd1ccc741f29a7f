"""`pendant sweep`: runs a study, tells how far it is, and says where its answer is."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from app.commands.command_options import AnyFile, Seed, example
from app.ending import ending

SWEEP_EXAMPLES = example(
    "pendant sweep sequence-limit --quick",
    "pendant sweep my-study.yaml --workers 8 --out results/mine",
    "pendant sweep my-study.yaml --scheduler tcp://10.0.0.1:8786",
)


def sweep_(
    study: Annotated[str, typer.Argument(metavar="STUDY", help="A study file, or the name of a bundled study.")],
    *,
    quick: Annotated[bool, typer.Option("--quick", help="The small size that the study names.")] = False,
    workers: Annotated[
        int | None, typer.Option(help="Processes of this machine; one for each core without it.", min=1, max=1024)
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A Dask scheduler whose workers do the runs.", show_default=False)
    ] = None,
    seed: Seed = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for rows/, report.html and worst/; out/STUDY without it.", show_default=False)
    ] = None,
    any_file: AnyFile = False,
) -> None:
    """Run a study: a session under many conditions. The same command goes on where it stopped."""
    from app.runs.progress import counting
    from app.studies.study_file import open_study
    from app.studies.sweep import Workers, sweep

    console = Console(stderr=True, soft_wrap=True)
    content, base = open_study(study, quick=quick, seed=seed, anywhere=any_file)
    name = Path(study).stem
    folder = out if out is not None else Path("out") / (f"{name}-quick" if quick else name)
    try:
        with ending(interrupts=True), counting("runs") as told:
            said = sweep(
                content,
                base,
                folder,
                where=Path(study).name,
                workers=Workers(workers, scheduler),
                told=told,
                said=lambda line: console.print(escape(line)),
            )
    except KeyboardInterrupt:
        console.print("What is done is kept; the same command goes on.")
        raise
    before = f", {said.kept} of them before" if said.kept else ""
    Console(soft_wrap=True).print(
        f"{said.runs} runs{before}; the rows are in {escape(str(folder / 'rows'))}, see {escape(str(folder / 'report.html'))}"
    )
    if said.failed:
        Console().print(f"{said.failed} runs ended with an error: the report names them")
        raise typer.Exit(1)
