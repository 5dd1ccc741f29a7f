"""The command `pendant export`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from app.commands.command_options import example
from app.ending import ending
from app.learning.export_defaults import RATE, TASK

EXAMPLES = example("pendant export logs/ --out demonstrations", "pendant export out/log.mcap --pictures")


def export_(
    recordings: Annotated[
        list[Path], typer.Argument(metavar="RECORDING...", help="Recordings, or folders of them; all of one kind of arm.")
    ],
    *,
    out: Annotated[Path, typer.Option(help="Folder of the data set; it must not be there yet.")] = Path("out/demonstrations"),
    rate: Annotated[int, typer.Option(help="Rows a second; it divides 500.")] = RATE,
    task: Annotated[str, typer.Option(help="What the demonstrations show, in a sentence.")] = TASK,
    pictures: Annotated[bool, typer.Option("--pictures", help="With videos, drawn from the recorded poses.")] = False,
) -> None:
    """Export guided demonstrations of recordings as a data set of LeRobot v3."""
    from app.learning.exported import export
    from app.runs.progress import counting

    with ending(interrupts=True), counting("recordings") as told:
        made = export(recordings, out, rate=rate, task=task, pictures=pictures, told=told)
    Console().print(escape(f"{made.demonstrations} demonstrations, {made.frames} rows: {made.folder}"))
