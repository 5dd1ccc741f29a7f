"""The command `pendant against`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from app.commands.command_options import (
    PORT,
    AnyFile,
    Config,
    LogColumns,
    LogEffort,
    Set,
    announce,
    example,
    set_up,
    setting,
)
from app.ending import ending
from app.session.session_file import Setup

AGAINST_EXAMPLES = example(
    "pendant against robot_data.csv --robot ur10e",
    "pendant against run.csv --robot ur10e --columns t,q,qd,current,-12 --out against",
    "pendant against bag.mcap --config cell.yaml",
    "pendant against out/log.mcap --page",
)


def against_(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="CSV of an RTDE recorder, a table, a bag of ROS 2, or a recording.")],
    *,
    robot: Annotated[str | None, typer.Option(help="Arm of the log: a name that `pendant robots` lists, or a file.")] = None,
    config: Config = None,
    columns: LogColumns = None,
    effort: LogEffort = "torque",
    set_: Set = None,
    out: Annotated[Path | None, typer.Option(help="Folder for a report and two CSV files.", show_default=False)] = None,
    page: Annotated[bool, typer.Option("--page", help="Replay it in the web app: the measured arm, and the model's.")] = False,
    any_file: AnyFile = False,
) -> None:
    """Hold a log of a real arm against the model: torques, friction as it is learned, contacts that would have been told.

    Tool, payload and mounting are those of --config; of a recording, its own.
    """
    from app.real_logs.against import hold_against
    from app.real_logs.against_page import sentences, tables, write
    from app.real_logs.log_reader import believed, read_log
    from app.runs.progress import counting
    from app.session.timeline_checks import applied

    prepared = set_up(robot, config, any_file, "against", shipped=Setup(mismatch="nominal"))
    prepared = believed(log, prepared, chosen=robot is not None or config is not None)
    changes = dict(setting(text) for text in set_ or [])
    prepared = prepared._replace(settings=applied(prepared.settings, changes, "against", "--set"))
    with ending(interrupts=True), counting("ticks") as told:
        found = hold_against(read_log(log, prepared.arm, columns=columns, effort=effort), prepared, told)
    console = Console()
    console.print(f"[bold]{escape(found.name)}[/bold] against the {escape(found.arm.name)}")
    for sentence in sentences(found):
        console.print(f"- {escape(sentence)}", soft_wrap=True)
    for caption, head, rows in tables(found):
        console.print(f"\n{escape(caption)}")
        if rows:
            table = Table(*head, box=None, pad_edge=False, collapse_padding=True)
            for row in rows:
                table.add_row(*map(escape, row))
            console.print(table)
    if out is not None:
        write(found, out)
        console.print(f"\nagainst.html, against.csv and contacts.csv are in {escape(str(out))}")
    if page:
        from app.serving import log_shown_until_interrupted

        with log_shown_until_interrupted(found, prepared, usual=PORT) as site:
            announce(f"Showing {found.name}", site.link, on_a_network=False)
