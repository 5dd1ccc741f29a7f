"""The command line `pendant`. Exit codes: 0 done, 1 an expectation or a check failed, 2 bad input, said in one line."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from app.commands.against_command import AGAINST_EXAMPLES, against_
from app.commands.command_exit import run_command_line
from app.commands.command_options import (
    PORT,
    AnyFile,
    Config,
    Host,
    Keep,
    Offset,
    Port,
    Programs,
    Record,
    RecordRates,
    RecordSplit,
    Robot,
    allowed_files,
    announce,
    announce_robot,
    as_kept,
    example,
    set_up,
)
from app.commands.export_command import EXAMPLES, export_
from app.commands.file_commands import CHECK_EXAMPLES, SCHEMA_EXAMPLES, check_, schema_
from app.commands.fit_command import FIT_EXAMPLES, fit_
from app.commands.import_command import IMPORT_EXAMPLES, import_
from app.commands.run_command import RUN_EXAMPLES, run_
from app.commands.sweep_command import SWEEP_EXAMPLES, sweep_
from app.files.bad_input import BadInput
from app.files.library import load_arm, own_robots, robots
from app.session.session_file import FIRST_START, Setup
from sim.arm.arm_file import Arm

app = typer.Typer(
    name="pendant",
    help="A teach pendant and the cobot behind it, simulated: in the browser, or headless.",
    add_completion=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
)


def _say_version(wanted: bool) -> None:
    if wanted:
        from app.engine.source import source_commit
        from app.files.versions import versions

        typer.echo(f"pendant {versions()['pendant']}, commit {source_commit()}")
        raise typer.Exit


@app.callback()
def begin(
    *,
    _version: Annotated[
        bool, typer.Option("--version", help="Show the version and the commit.", is_eager=True, callback=_say_version)
    ] = False,
) -> None:
    """A teach pendant and the cobot behind it, simulated: in the browser, or headless."""


@app.command(
    epilog=example(
        "pendant serve --open",
        "pendant serve --robot ur10e --port 9000",
        "pendant serve --config cell.yaml",
        "pendant serve --host 0.0.0.0",
        "pendant serve --record logs",
        "pendant serve --record logs --record-split 60 --record-rates state=50,truth=10,pictures=10",
        "pendant serve --interfaces",
        "pendant serve --fresh",
    )
)
def serve(
    *,
    robot: Robot = None,
    config: Config = None,
    host: Host = "127.0.0.1",
    port: Port = None,
    open_browser: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
    record: Record = None,
    record_rates: RecordRates = None,
    record_split: RecordSplit = None,
    interfaces: Annotated[
        bool,
        typer.Option(
            "--interfaces", help="Serve the robot on the network too: RTDE, dashboard and more, as UR's clients know it."
        ),
    ] = False,
    port_offset: Offset = 0,
    programs: Programs = None,
    any_file: AnyFile = False,
    keep: Keep = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Begin as shipped, and keep nothing for the next start.")] = False,
) -> None:
    """Serve the web app: push the arm, hold its free-drive button, read why it stopped.

    Set-up, settings and what was taught are kept for the next start with the same arm, unless --config says what to begin with.
    """
    from app.log.recording_plan import recording_plan
    from app.serving import Network, serve_until_interrupted

    plan = recording_plan(record_rates, record_split)
    prepared = set_up(robot, config, any_file, "serve", shipped=FIRST_START)
    keeper, cell = None, None
    if not fresh and (config is None or keep is not None):
        prepared, keeper, cell = as_kept(prepared, keep)
    network = Network(host, port_offset, programs, allowed_files(config, any_file)) if interfaces else None
    with serve_until_interrupted(
        prepared,
        host=host,
        port=port,
        usual=PORT,
        open_browser=open_browser,
        record=record,
        plan=plan,
        network=network,
        keeper=keeper,
        cell=cell,
    ) as serving:
        announce(f"Serving the {prepared.arm.name}", serving.site.link, serving.site.access.token is not None)
        if serving.interfaces is not None:
            announce_robot(prepared.arm, serving.interfaces)


@app.command(
    "robot", epilog=example("pendant robot", "pendant robot --robot ur10e --port-offset 100", "pendant robot --host 127.0.0.2")
)
def robot_(
    *,
    robot: Robot = None,
    config: Config = None,
    host: Host = "127.0.0.1",
    port_offset: Offset = 0,
    programs: Programs = None,
    record: Record = None,
    record_rates: RecordRates = None,
    record_split: RecordSplit = None,
    any_file: AnyFile = False,
) -> None:
    """Serve a robot on the network, without a page: RTDE, dashboard, client interfaces, faults on command."""
    from app.log.recording_plan import recording_plan
    from app.robot_serving import Network, get_ready, robot_until_interrupted

    plan = recording_plan(record_rates, record_split)
    prepared = set_up(robot, config, any_file, "robot", shipped=Setup())
    get_ready(prepared.arm)
    network = Network(host, port_offset, programs, allowed_files(config, any_file))
    with robot_until_interrupted(prepared, network, record, plan) as interfaces:
        announce_robot(prepared.arm, interfaces)


app.command("run", epilog=RUN_EXAMPLES)(run_)
app.command("sweep", epilog=SWEEP_EXAMPLES)(sweep_)
app.command("fit", epilog=FIT_EXAMPLES)(fit_)
app.command("import", epilog=IMPORT_EXAMPLES)(import_)
app.command("schema", epilog=SCHEMA_EXAMPLES)(schema_)
app.command("check", epilog=CHECK_EXAMPLES)(check_)


@app.command(epilog=example("pendant replay out/log.mcap --open"))
def replay(
    log: Annotated[
        Path,
        typer.Argument(metavar="LOG", help="A recording, or the folder of its parts; a file without its end is repaired."),
    ],
    host: Host = "127.0.0.1",
    port: Port = None,
    open_browser: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
) -> None:
    """Show a recording in the web app, with a time line; nothing is simulated."""
    from app.serving import replay_until_interrupted

    with replay_until_interrupted(log, host=host, port=port, usual=PORT, open_browser=open_browser) as site:
        announce(f"Showing {log}", site.link, site.access.token is not None)


app.command("export", epilog=EXAMPLES)(export_)
app.command("against", epilog=AGAINST_EXAMPLES)(against_)


@app.command("robots", epilog=example("pendant robots", "pendant serve --robot ur3e"))
def robots_() -> None:
    """List the arms, with reach, payload, mass, joints and the source of their data."""
    table = Table("name", "title", "reach [m]", "payload [kg]", "mass [kg]", "joints", "source", box=None, pad_edge=False)
    for column in (2, 3, 4, 5):
        table.columns[column].justify = "right"
    for name in [*robots(), *own_robots()]:
        try:
            arm = load_arm(name)
        except BadInput as refusal:
            Console(stderr=True, soft_wrap=True).print(escape(str(refusal)))
            continue
        table.add_row(
            name, arm.title, f"{arm.reach:g}", f"{arm.payload:g}", f"{sum(arm.masses.mass):.1f}", str(arm.n), _source(arm)
        )
    Console().print(table)


def _source(arm: Arm) -> str:
    """Where the masses come from, without the fine print after the first semicolon; the file says the rest."""
    return " ".join(arm.masses.source.split()).partition(";")[0]


def main() -> None:
    """Run the command line."""
    run_command_line(app)
