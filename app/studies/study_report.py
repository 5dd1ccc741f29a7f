"""report.html of a study, from its data set, and session files of the worst runs."""

import math
from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from app.engine.source import identity, source_commit
from app.report.document import Raw, document, mark, table
from app.report.drawing import svg_of
from app.studies.data_set import read_data_set, whole_file
from app.studies.plan import Plan, plain, session_of
from app.studies.study_charts import curves, heat_map, roc_chart, sensitivity, short
from app.studies.study_file import AnyShown, HeatMap, ResponseCurve, Roc, Sensitivity, Study
from app.studies.study_statistics import SobolIndex, curve, first_order, levels, pivot, roc, worst


class Rows:
    """The data set as numpy arrays; of measures, true and false are 1 and 0, and nothing is NaN."""

    def __init__(self, folder: Path, study: Study) -> None:
        self._table = read_data_set(folder)
        self._study = study
        self.count = self._table.num_rows
        self.failed = self.column("exit") != "ok"

    def column(self, name: str) -> NDArray[Any]:
        """Of a factor, or another column that every row has."""
        values = self._table[name].to_numpy()
        if values.dtype.kind == "b":
            return np.where(values, "true", "false")
        return values if values.dtype.kind in "fi" else values.astype(str)

    def measure(self, name: str) -> NDArray[np.float64]:
        """Of a measure."""
        import pyarrow as pa

        values = self._table[name]
        return np.asarray(values.cast(pa.int8()).cast(pa.float64()) if pa.types.is_boolean(values.type) else values, dtype=float)


def figures(study: Study, rows: Rows) -> list[tuple[str, Figure]]:
    """Captions and figures of what the study shows; a figure without numbers is left out."""
    drawn: list[tuple[str, Figure]] = []
    for shown in study.show:
        if not isinstance(shown, Sensitivity):
            figure = _figure(shown, study, rows)
            if figure is not None:
                drawn.append((shown.caption or _caption(shown), figure))
    indices: dict[str, list[SobolIndex]] = {}
    for shown in study.show:
        if isinstance(shown, Sensitivity):
            found = first_order({each.name: rows.column(each.name) for each in study.factors}, rows.measure(shown.of))
            if found is not None:
                indices[shown.of] = found
    if indices:
        caption = "Sensitivity: first-order indices (RBD-FAST of SALib), with 95 % intervals by resampling"
        drawn.append((caption, sensitivity(indices)))
    return drawn


def _figure(shown: AnyShown, study: Study, rows: Rows) -> Figure | None:
    y, share = rows.measure(shown.of), _shares(study, shown.of)
    if not np.isfinite(y).any():
        return None
    match shown:
        case ResponseCurve(by=None):
            return curves(
                {"": curve(rows.column(shown.over), y, share)}, _axis(study, shown.over), _axis(study, shown.of), share=share
            )
        case ResponseCurve():
            x = rows.column(shown.over)
            lines = {short(value): curve(x[mine], y[mine], share) for value, mine in levels(rows.column(shown.by or ""))}
            names = _axis(study, shown.over), _axis(study, shown.of)
            return curves(lines, *names, share=share, by=_axis(study, shown.by or ""))
        case HeatMap():
            a, b = shown.over
            if min(len(levels(rows.column(name))) for name in (a, b)) < 2:  # of a quick size
                return None
            found = pivot(rows.column(a), rows.column(b), y)
            return heat_map(*found, [_axis(study, name) for name in (a, b, shown.of)], share=share)
        case Roc():
            points = roc(shown, rows.column(shown.over), rows.column(shown.right).astype(float), y)
            return roc_chart(points, _axis(study, shown.over)) if any(each.true.n and each.false.n for each in points) else None
    return None


def _shares(study: Study, name: str) -> bool:
    return next(each for each in study.measures if each.name == name).shares


def _axis(study: Study, name: str) -> str:
    unit = next((each.unit for each in (*study.factors, *study.measures) if each.name == name), "")
    return name.replace("_", " ") + (f" [{unit}]" if unit else "")


def _caption(shown: AnyShown) -> str:
    of = shown.of.replace("_", " ")
    factors = " and ".join(name.replace("_", " ") for name in shown.factors())
    if isinstance(shown, Roc):
        return f"{of.capitalize()}: true against false, for each {shown.over.replace('_', ' ')}, with 95 % intervals"
    return (
        f"{of.capitalize()} over {factors}: mean, with its 95 % interval"
        if isinstance(shown, ResponseCurve)
        else f"{of.capitalize()} over {factors}: mean"
    )


def worst_runs(plan: Plan, rows: Rows, out: Path) -> list[tuple[str, ...]]:
    """Write a session file for each of the ten worst runs; a row of the report each, with the command that repeats it.

    Raises:
        BadInput: a file cannot be written.
    """
    study, chosen = plan.study, plan.study.worst
    y = rows.measure(chosen.of) if chosen is not None else np.full(rows.count, math.nan)
    numbers, errors = rows.column("run"), rows.column("error")
    found: list[tuple[str, ...]] = []
    for place in worst(y, rows.failed, chosen is None or chosen.first == "largest"):
        case = plan.case(int(numbers[place]))
        name = f"run-{case.number:06d}"
        path = out / "worst" / f"{name}.yaml"
        text = _as_session(plan, case.values, case.seed)
        whole_file(path, _writer(text))
        what = " ".join(f"{factor.name} {_told(value)}" for factor, value in zip(study.factors, case.factors, strict=True))
        came = str(errors[place]) if rows.failed[place] else _told(float(y[place]))
        robot = " --any-file" if "/" in plan.base.robot or "/" in str(plan.base.tool) else ""
        command = f"pendant run {path} --out {out / 'worst' / name}{robot}"
        found.append((str(case.number), str(case.seed), what, came, Raw(f"<code>{escape(command)}</code>")))
    return found


def _writer(text: bytes) -> Callable[[Path], object]:
    return lambda place: place.write_bytes(text)


def _as_session(plan: Plan, values: Any, seed: int) -> bytes:
    """The run as a session file; one that cannot be made is written as far as it goes, for `pendant run` says what is wrong."""
    from app.files.bad_input import BadInput

    raw = plain(plan.base)
    try:
        raw = plain(session_of(raw, values, seed, "session"))
    except BadInput:
        from app.studies.factors import put

        for path, value in values:
            put(raw, path, value)
        raw["seed"] = seed
    return msgspec.yaml.encode(raw)


def _told(value: float | bool | str) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def write_study_report(plan: Plan, out: Path, rows_folder: Path) -> int:
    """Write `out`/report.html; gives the number of runs with an error.

    Args:
        plan: of the study.
        out: folder for the report and the worst runs.
        rows_folder: the data set.

    Raises:
        BadInput: a file cannot be written.
    """
    study, rows = plan.study, Rows(rows_folder, plan.study)
    failed, title = int(rows.failed.sum()), escape(study.title)
    whole = rows.count == plan.size and not failed
    state = f"{rows.count} of {plan.size} runs" + (f", {failed} of them with an error" if failed else "")
    drawn = [(caption, svg_of(figure)) for caption, figure in figures(study, rows)]
    runs = worst_runs(plan, rows, out)
    chosen = "" if study.worst is None else f": {study.worst.first} {study.worst.of.replace('_', ' ')}"
    parts = [
        f"<h1>{title}</h1>",
        f'<p class="verdict">{mark(whole, state, state)}</p>',
        f"<p>{escape(study.text)}</p>",
        *(f"<figure>{svg}<figcaption>{escape(caption)}</figcaption></figure>" for caption, svg in drawn),
        f"<h2>The ten worst runs{escape(chosen)}</h2>",
        "<p>Each command repeats its run with a full recording.</p>",
        table(("run", "seed", "factors", "came to", "command"), runs, "No run is told apart."),
        "<h2>Factors</h2>",
        table(("factor", "unit", "field", "kind", "values"), [_of_factor(plan, k) for k in range(len(study.factors))]),
        "<h2>Measures</h2>",
        table(
            ("measure", "unit", "runs with a value", "mean", "smallest", "largest"),
            [_of_measure(study, rows, each.name) for each in study.measures],
        ),
        "<h2>What ran</h2>",
        table(
            (),
            [
                ("session", plan.base.title),
                ("seeds", f"{plan.base.seed} and on, {study.seeds} each"),
                ("commit", source_commit()),
                *identity().items(),
            ],
        ),
    ]
    text = document(title, parts)
    whole_file(out / "report.html", lambda place: place.write_text(text, encoding="utf-8"))
    return failed


def _of_factor(plan: Plan, k: int) -> tuple[str, ...]:
    factor = plan.study.factors[k]
    kind = str(msgspec.to_builtins(factor)["kind"])
    shown = list(dict.fromkeys(plan.case(number).factors[k] for number in _sampled(plan.size)))
    numbers = [value for value in shown if isinstance(value, float)]
    few = ", ".join(map(_told, sorted(numbers) if numbers else shown))
    span = f"{min(numbers):.4g} .. {max(numbers):.4g}" if len(numbers) > 6 else few
    return factor.name, factor.unit, ", ".join(factor.fields), kind.replace("_", " "), span


def _sampled(size: int, most: int = 5000) -> range:
    """Numbers of runs, at most so many, evenly over all."""
    return range(0, size, max(1, size // most | 1))


def _of_measure(study: Study, rows: Rows, name: str) -> tuple[str, ...]:
    unit = next(each.unit for each in study.measures if each.name == name)
    y = rows.measure(name)
    y = y[np.isfinite(y)]
    numbers = (f"{y.mean():.4g}", f"{y.min():.4g}", f"{y.max():.4g}") if len(y) else ("", "", "")
    return name, unit or ("true or false" if _shares(study, name) else ""), str(len(y)), *numbers
