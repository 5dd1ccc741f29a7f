"""What became of a log that was held against the controller, as tables, a page and a CSV file."""

from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from app.real_logs.against import WATCHED, Against, after_learning
from app.real_logs.torque_residuals import LEARNED
from app.report.document import document, table
from app.report.drawing import empty_axes, svg_of

Array = NDArray[np.float64]
Table = tuple[str, list[str], list[list[str]]]
"""Caption, head, rows."""

POINTS = 4000
"""Of a line in a figure, at most."""
STEP = 5.0
"""Motion over which learned friction is judged in the figure of it [s]."""
LISTED = 40
"""Rows of what would have been told, at most; the CSV file of them has all."""


def tables(found: Against) -> list[Table]:
    """The figures, of which a page and a terminal make tables."""
    joints = found.arm.chain.joints
    measured, bare, fixed, learned = found.residuals.rms()
    fit = found.residuals.fitted()
    rows = [
        [
            joint,
            *(_n(measured[i]), _n(bare[i]), _n(fixed[i]), _share(fixed[i], measured[i])),
            *(_n(learned[i]), _share(learned[i], measured[i]), _n(fit[i]), _n(found.external[i]), _n(found.largest[i])),
        ]
        for i, joint in enumerate(joints)
    ]
    head = ["joint", "measured", "no friction", "fixed", "share", "learned", "share", "fit", "external", "largest"]
    out: list[Table] = [("Torque while the joint moves, root mean square [N·m]: measured, and what is left of it", head, rows)]
    later = after_learning(found)
    if later is not None:
        (_, _, by_file, own), started = later
        more = [
            [joint, _n(by_file[i]), *(_n(each[i]) for each in (own, *(of[3] for of in started.values())))]
            for i, joint in enumerate(joints)
        ]
        caption = f"What friction leaves from {LEARNED:.0f} to {WATCHED:.0f} s of motion [N·m], fixed and learned"
        out.append((caption, ["joint", "fixed", "from the file", *(f"from {name}" for name in started)], more))
    told = [[f"{each.t:.2f}", each.what, each.part, f"{each.force:.0f}", each.rule] for each in found.told]
    caption = f"What would have been told: {len(told)} in {found.seconds:.0f} s"
    out.append((caption, ["time [s]", "what", "part", "force [N]", "rule"], told[:LISTED]))
    return out


def sentences(found: Against) -> list[str]:
    """What is said of the log beside its tables."""
    said = [f"{found.seconds:.1f} s at {found.rate:.0f} rows a second; some joint moves in {found.residuals.moved:.1f} s"]
    if found.force is not None:
        said.append(f"force on the flange: {found.force[0]:.1f} N root mean square, {found.force[1]:.1f} N at most")
    if after_learning(found) is None:
        said.append(f"less than {LEARNED:.0f} s of motion: nothing is told of friction that was learned")
    if len(found.told) > LISTED:
        said.append(f"{len(found.told) - LISTED} more would have been told: contacts.csv has them")
    return said + found.said


def write(found: Against, out: Path) -> None:
    """Write the page, the lines in its figures and the contacts into a folder."""
    joints = found.arm.chain.joints
    names = ("q", "tau_m", "predicted", "fixed_friction", "tau_ext")
    head = ["t", *(f"{name}_{joint}" for name in names for joint in joints), "F_x", "F_y", "F_z"]
    out.mkdir(parents=True, exist_ok=True)
    np.savetxt(out / "against.csv", found.table, fmt="%.6g", delimiter=",", header=",".join(head), comments="")
    lines = [f"{each.t:.3f},{each.what},{each.part},{each.force:.2f},{each.rule}" for each in found.told]
    (out / "contacts.csv").write_text("\n".join(["t,what,part,force,rule", *lines]) + "\n", encoding="utf-8")
    (out / "against.html").write_text(_page(found), encoding="utf-8")


def _page(found: Against) -> str:
    title = f"{found.name} against {found.arm.title}"
    said = "".join(f"<li>{escape(each)}</li>" for each in sentences(found))
    parts = [f"<h1>{escape(title)}</h1>", f"<ul>{said}</ul>"]
    for caption, head, rows in tables(found):
        parts += [f"<h2>{escape(caption)}</h2>", table(head, rows, "Nothing.")]
    n, values = found.arm.n, found.table
    values = values[:: max(1, -(-len(values) // POINTS))]
    t = values[:, 0]
    marks = [each.t for each in found.told]
    for i, joint in enumerate(found.arm.chain.joints):
        named = (("measured", 1), ("predicted", 2), ("external", 4))
        lines = [(name, values[:, 1 + block * n + i]) for name, block in named]
        parts.append(_figure(f"{joint}: motor torque; dotted: something would have been told", "torque [N·m]", (t, marks), lines))
    if found.force is not None:
        force = [(axis, values[:, 1 + 5 * n + k]) for k, axis in enumerate("xyz")]
        parts.append(_figure("Force on the flange, in the base's axes", "force [N]", (t, marks), force))
    if found.started and found.residuals.moved > 2.0 * STEP:
        caption = "Friction as it is learned: what is left, over what the file's leaves"
        parts.append(_figure(caption, "share", *_learning(found), below="motion [s]"))
    return document(escape(title), parts)


def _learning(found: Against) -> tuple[tuple[Array, list[float]], list[tuple[str, Array]]]:
    """Each `STEP`, root mean square over the joints, each over its rated torque, for each start."""
    limit = np.array(found.arm.limits.torque)
    runs = {"from the file": found.residuals, **{f"from {name}": each for name, each in found.started.items()}}
    begins = np.arange(0.0, min(found.residuals.moved, 2.0 * WATCHED), STEP)
    lines = []
    for name, run in runs.items():
        left = np.array([run.rms(begin, begin + STEP) / limit for begin in begins])[:, 2:]
        fixed, learned = (np.nan_to_num(left[:, k]) for k in (0, 1))
        sizes = np.linalg.norm(fixed, axis=1)
        lines.append((name, np.linalg.norm(learned, axis=1) / np.where(sizes > 0.0, sizes, np.nan)))
    return (begins, []), lines


def _figure(
    caption: str,
    label: str,
    along: tuple[Array, Sequence[float]],
    lines: Sequence[tuple[str, Array]],
    *,
    below: str = "time [s]",
) -> str:
    t, marks = along
    figure, axes = empty_axes(1.8, 0.2)
    for name, values in lines:
        axes.plot(t, values, linewidth=0.8, label=name)
    for mark in marks:
        axes.axvline(mark, color="#868e96", linewidth=0.5, linestyle=":")
    axes.set_xlabel(below, fontsize=7.5)
    axes.set_ylabel(label, fontsize=7.5)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.97), fontsize=6.5, frameon=False, ncols=len(lines))
    return f"<figure>{svg_of(figure)}<figcaption>{escape(caption)}</figcaption></figure>"


def _n(value: float) -> str:
    return f"{value:.2f}" if np.isfinite(value) else "still"


def _share(part: float, whole: float) -> str:
    return f"{100.0 * part / whole:.0f} %" if np.isfinite(part) and whole > 0.0 else "still"
