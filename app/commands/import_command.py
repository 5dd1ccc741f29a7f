"""The command `pendant import`: an arm file from a URDF or MJCF file."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from app.commands.command_options import example
from app.files.bad_input import BadInput

IMPORT_EXAMPLES = example(
    "pendant import panda.urdf --flange panda_link8",
    "pendant import xarm7.xml --out arms --measured my-values.yaml",
    "pendant import robots/arm.urdf --within . --drive servo",
    "pendant import panda_description",
)


def import_(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE", help="The arm's URDF or MJCF, a folder that holds one, or a name of robot-descriptions, if installed."
        ),
    ],
    *,
    flange: Annotated[
        str | None, typer.Option(metavar="LINK", help="Link or site that tools are mounted on; what moves beyond it is locked.")
    ] = None,
    name: Annotated[str | None, typer.Option(help="Name of the arm; without it that of the description.")] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder of arms; without it your own, whose arms go by name.", file_okay=False)
    ] = None,
    measured: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Measured values, in the form of an arm file: they replace what they name."),
    ] = None,
    drive: Annotated[str | None, typer.Option(help="harmonic or servo; without it by size.")] = None,
    within: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Meshes may be read from here; without it from beside the file.")
    ] = None,
) -> None:
    """Import an arm: chain, masses and limits as the file has them, the rest estimated by size, with pictures for the page."""
    from app.arm_import.import_files import written
    from app.arm_import.importing import imported
    from app.arm_import.named_descriptions import named_description
    from app.files.library import own_arms

    if drive not in (None, "harmonic", "servo"):
        raise BadInput("--drive", "", drive, "expected harmonic or servo")
    meant = named_description(file)
    found = imported(meant.file, flange=flange, name=name, drive=drive, within=within or meant.within, values=measured)
    path = written(found, meant.file, own_arms() if out is None else out)
    console = Console(soft_wrap=True)
    arm = found.arm
    console.print(
        escape(f"{arm.name}: {arm.n} joints, {sum(arm.masses.mass):.3g} kg, reach {arm.reach:g} m, payload {arm.payload:g} kg")
    )
    console.print(f"MuJoCo, Pinocchio and the arm file agree in {found.postures} postures: kinematics, gravity, mass matrix")
    for line in found.told:
        console.print(escape(line))
    if found.measured:
        console.print(escape(f"measured: {', '.join(found.measured)}"))
    console.print("Assumed; measure first, from the top:")
    for number, (field, does) in enumerate(found.assumed, 1):
        console.print(escape(f"  {number}. {field}: {does}"))
    console.print(escape(f"Written: {path}"))
    if found.tool is None:
        console.print(escape(f"Next: pendant serve --open --robot {path if out is not None else arm.name}"))
    else:
        console.print(escape(f"Beyond the flange: {found.tool.mass:.3g} kg, as the tool {found.tool.name}"))
        console.print(escape(f"Next: pendant serve --open --config {path.with_name('cell.yaml')}"))
