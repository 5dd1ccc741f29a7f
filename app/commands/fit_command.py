"""The command `pendant fit`: an arm's file from logs of an arm."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from app.commands.command_options import LogColumns, LogEffort, example
from app.files.bad_input import BadInput

if TYPE_CHECKING:
    from app.real_logs.fitting import Fitted

FIT_EXAMPLES = example(
    "pendant fit monday.csv tuesday.csv --robot ur10e --out my-arm.yaml",
    "pendant fit bare.csv loaded.csv --load loaded.csv=2.8 --robot ur10e --judge other.csv --out my-arm.yaml",
    "pendant fit table.csv --columns t,q,qd,current,-12 --robot ur10e --out my-arm.yaml",
)

OF_ITSELF = "left by lines of its own"
"""The usual yardstick: sign, speed, rigid torque and offset by least squares, of the log that is judged."""


def fit_(
    logs: Annotated[list[Path], typer.Argument(metavar="LOG...", help="Logs to learn from: CSV, MCAP, or recordings.")],
    *,
    robot: Annotated[str, typer.Option(help="The arm: a name that `pendant robots` lists, or a file.")],
    out: Annotated[Path, typer.Option(help="File of the fitted arm.")] = Path("my-arm.yaml"),
    load: Annotated[
        list[str] | None,
        typer.Option(metavar="LOG=KG", help="A log in which the arm carries a load, with its mass; LOG=? where it is unknown."),
    ] = None,
    judge: Annotated[
        list[Path] | None, typer.Option(metavar="LOG", help="A log to judge with, and not to learn from; repeatable.")
    ] = None,
    columns: LogColumns = None,
    effort: LogEffort = "torque",
) -> None:
    """Fit an arm to its logs: friction, rotor inertia, torque constants, centres of mass, and the load."""
    from app.files.library import load_arm
    from app.real_logs.fitting import fit_logs, written
    from app.real_logs.log_reader import read_log

    arm = load_arm(robot, "--robot")
    read = [read_log(path, arm, columns=columns, effort=effort) for path in [*logs, *(judge or [])]]
    console = Console(soft_wrap=True)
    for log in read:
        console.print(
            escape(f"{log.name}: {log.seconds:.0f} s, {log.rate:.0f} rows a second{''.join(f'; {t}' for t in log.told)}")
        )
    loads = _loads(load or [], [log.name for log in read])
    name = re.sub(r"[^a-z0-9-]", "-", out.stem.lower())
    fitted = fit_logs(arm, read[: len(logs)], read[len(logs) :], loads=loads, name=name)
    written(fitted, out)
    _show(console, fitted, loaded=bool(loads))
    console.print(escape(f"Written: {out}"))


def _loads(said: list[str], names: list[str]) -> dict[str, float | None]:
    loads: dict[str, float | None] = {}
    for text in said:
        log, equals, mass = text.rpartition("=")
        log = Path(log).name
        if not equals or log not in names:
            raise BadInput("--load", "", text, f"expected LOG=KG or LOG=?, with a log of {', '.join(names)}")
        try:
            loads[log] = None if mass == "?" else float(mass)
        except ValueError:
            raise BadInput("--load", log, mass, "expected a mass in kilograms, or ?") from None
        if not 0.0 < (loads[log] or 1.0) <= 100.0:
            raise BadInput("--load", log, mass, "expected more than 0 and at most 100 kg")
    return loads


def _show(console: Console, fitted: "Fitted", *, loaded: bool) -> None:
    from app.real_logs.fitting import LEAST_MOTION

    found, at = fitted.found, fitted.found.places
    x, d, arm = found.x, found.deviation, found.model.arm
    joints = arm.chain.joints
    curves = Table("friction [N·m]", *(f"{speed:g} rad/s" for speed in arm.frictions.speed), box=None, pad_edge=False)
    others = Table("", "torque constant", "rotor [kg·m²]", "friction per load", "forwards [N·m]", box=None, pad_edge=False)
    for i, joint in enumerate(joints):
        points = zip(x[at.curve(i)], d[at.curve(i)], strict=True)
        curves.add_row(joint, *(f"{value:.2f} ± {sure:.2f}" for value, sure in points))
        cells = [_pm(x[part][i], d[part][i]) for part in (at.rotor, at.load_friction, at.offset)]
        others.add_row(joint, f"{100 * x[at.constant][i]:+.1f} ± {100 * d[at.constant][i]:.1f} %", *cells)
    console.print(curves)
    console.print(others)
    if loaded:
        mass, *first = x[at.load][:4]
        centre = ", ".join(f"{each / mass:.3f}" for each in first) if mass > 0 else ""
        console.print(escape(f"Load: {mass:.3f} ± {d[at.load][0]:.3f} kg, centre {centre} m from the flange"))
    for run in fitted.judged:
        if np.isnan(run.measured).all():
            console.print(escape(f"Left out of the fit: {run.name}, in which no joint moves for {LEAST_MOTION:g} s: not judged"))
            continue
        console.print(escape(f"Left out of the fit: {run.name}, RMS of joint torque [N·m]"))
        table = Table("", *joints, box=None, pad_edge=False)
        rows = {"measured": run.measured, "left by the file": run.before, "left by the fit": run.after, OF_ITSELF: run.best}
        for what, row in rows.items():
            table.add_row(what, *("-" if np.isnan(v) else f"{v:.2f}" for v in row))
        console.print(table)
    for line in fitted.told:
        console.print(escape(f"Not told: {line}"))


def _pm(value: float, deviation: float) -> str:
    return f"{value:.3f} ± {deviation:.3f}"
