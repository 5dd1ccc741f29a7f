"""Options that several commands of `pendant` share, and what the commands say when they serve."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer
from rich.console import Console
from rich.markup import escape

from app.files.bad_input import ABSENT, BadInput
from pendant.all_settings import find as find_setting
from pendant.settings.schema import SettingError
from sim.arm.arm_file import Arm

if TYPE_CHECKING:
    from app.kept_setup import Cell, Keeper
    from app.robot_interface.interfaces import RobotInterfaces
    from app.session.prepare import Prepared
    from app.session.session_file import AllowedFiles, Setup

PORT = 8080
"""Where the web app is, when this port is free and no other was asked for."""

Robot = Annotated[str | None, typer.Option(help="Arm to serve: a name that `pendant robots` lists, or a file.")]
Config = Annotated[
    Path | None, typer.Option(help="YAML file: the header of a session, without its time line.", show_default=False)
]
Host = Annotated[str, typer.Option(help="Address to listen on; 0.0.0.0 opens the page to the network.")]
Port = Annotated[
    int | None, typer.Option(help=f"Port; 0 for any free one. Without it {PORT}, or any free one.", min=0, max=65535)
]
SessionNames = Annotated[
    list[str], typer.Argument(metavar="SESSION...", help="Session files, folders of them, or names of bundled sessions.")
]
Out = Annotated[
    Path, typer.Option(help="Folder for events.jsonl, log.mcap, summary.json, report.html; of several sessions, a folder each.")
]
Seed = Annotated[int | None, typer.Option(help="Seed in place of the file's.", min=0, max=2**31 - 1)]
Seeds = Annotated[
    str | None,
    typer.Option(metavar="SEEDS", help="Run each session at each of these seeds, such as 1-12 or 1,3,7-9.", show_default=False),
]
Offset = Annotated[int, typer.Option("--port-offset", help="Added to all ports, for a second robot.", min=0, max=30000)]
Programs = Annotated[
    Path | None,
    typer.Option(
        help="Folder of programs that clients can load, beside those bundled.", file_okay=False, exists=True, show_default=False
    ),
]
Record = Annotated[
    Path | None,
    typer.Option(help="Record from the start, into this folder; the page has a switch for it.", show_default=False),
]
RecordRates = Annotated[
    str | None,
    typer.Option(
        "--record-rates",
        metavar="TOPIC=RATE,...",
        help="Record less: state, truth, pictures, a second. All of them without it.",
        show_default=False,
    ),
]
RecordSplit = Annotated[
    float | None,
    typer.Option("--record-split", metavar="MINUTES", help="Record in files of so many minutes.", show_default=False),
]
AnyFile = Annotated[bool, typer.Option("--any-file", help="Arms and tools that a file names may be in any folder.")]
Set = Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Setting in place of the file's; repeatable.")]

LogColumns = Annotated[
    str | None,
    typer.Option(
        "--columns",
        help="What the columns of a table are, such as t,q,qd,current,-12 or t:ms,q:deg,torque.",
        show_default=False,
    ),
]
LogEffort = Annotated[str, typer.Option("--effort", help="What the effort of a bag's JointState is: torque or current.")]

Keep = Annotated[
    Path | None,
    typer.Option(
        help="Folder where the cell of each arm is kept; without it the user's own for such.",
        file_okay=False,
        show_default=False,
    ),
]


def as_kept(prepared: "Prepared", folder: Path | None) -> tuple["Prepared", "Keeper | None", "Cell | None"]:
    """What was kept of the arm in place of what is shipped, with its keeper and the cell. A file that cannot be used
    is told of in a line, and stays as it is."""
    from app.kept_setup import check_cell, keeper_for, usual_folder

    keeper = keeper_for(prepared.arm, folder or usual_folder())
    console = Console(soft_wrap=True)
    try:
        kept = None if keeper is None else keeper.read()
        if keeper is None or kept is None:
            return prepared, keeper, None
        again = check_cell(kept, keeper.path.name)
        console.print(escape(f"As kept in {keeper.path}; --fresh begins as shipped"))
        return again, keeper, kept
    except BadInput as refusal:
        console.print(escape(f"Not taken, and nothing is kept: {refusal}"))
        return prepared, None, None


def example(*lines: str) -> str:
    """Examples at the end of a command's help."""
    return "Examples:\n" + "\n".join(f"  {escape(line)}" for line in lines)


def announce_robot(arm: Arm, interfaces: "RobotInterfaces") -> None:
    """Say where the robot's interfaces are."""
    console, host, ports = Console(soft_wrap=True), interfaces.host, interfaces.ports
    numbers = ", ".join(f"{name} {number}" for name, number in ports.items() if "read-only" not in name and name != "control")
    console.print(escape(f"Robot {arm.name} at {host}: {numbers}  (stop with Ctrl-C)"))
    console.print(escape(f"Control channel at http://{host}:{ports['control']} with the token {interfaces.token}"))
    if interfaces.on_a_network:
        console.print("Open to the network: these protocols know no password, so whoever reaches it can move the simulated arm.")


def announce(what: str, link: str, on_a_network: bool) -> None:
    """Say where the page is, in one line however narrow the terminal: a link that is cut does not open."""
    console = Console(soft_wrap=True)
    console.print(escape(f"{what} at {link}  (stop with Ctrl-C)"))
    if on_a_network:
        console.print("Open to the network, unencrypted: whoever has this link can move the arm. The next start makes a new one.")


def setting(text: str) -> tuple[str, float | bool | str]:
    """A `--set KEY=VALUE` as name and value.

    Raises BadInput: it has no "=", or there is no such setting. The value is checked with the session's own.
    """
    name, equals, value = text.partition("=")
    if not equals:
        raise BadInput("--set", "", text, "expected KEY=VALUE, such as free_drive.period=5")
    try:
        find_setting(name)
    except SettingError as error:
        raise BadInput("--set", name, ABSENT, error.allowed) from None
    if value in ("true", "false"):
        return name, value == "true"
    try:
        return name, float(value)
    except ValueError:
        return name, value


def allowed_files(config: Path | None, any_file: bool) -> "AllowedFiles":
    """What a set-up may name that comes over the network: what one of the command line may."""
    from app.session.session_file import AllowedFiles

    return AllowedFiles(None if config is None else config.parent.resolve(), any_file)


def set_up(robot: str | None, config: Path | None, any_file: bool, command: str, *, shipped: "Setup") -> "Prepared":
    """What the options of a command ask for; `shipped` where no file says it."""
    from app.files.checked import load
    from app.kept_setup import Cell, is_cell
    from app.session.prepare import prepare
    from app.session.session_file import Setup, opened

    setup = shipped
    if config is not None:
        setup = load(config, Cell).setup if is_cell(config) else opened(config, Setup, any_file)
    if robot is not None:
        setup = msgspec.structs.replace(setup, robot=robot)
    return prepare(setup, command if config is None else config.name)
