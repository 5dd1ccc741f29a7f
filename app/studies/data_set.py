"""The rows of a study as a Parquet data set: files of some ten thousand rows in order, each replaced as a whole or not at all."""

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from app.files.bad_input import ABSENT, BadInput
from app.studies.factors import Gridded
from app.studies.study_file import Study

PART = 20_000
"""Runs in a file: that many rows are in memory at once when they are written."""


def schema_of_rows(study: Study) -> Any:
    """The columns: run, id, seed, factors, measures, exit, error, commit, digest."""
    import pyarrow as pa

    def kind(values: Iterable[object]) -> Any:
        types = {type(value) for value in values}
        return pa.string() if str in types else pa.bool_() if types == {bool} else pa.float64()

    columns = [("run", pa.int64()), ("id", pa.string()), ("seed", pa.int64())]
    columns += [(each.name, kind(each.shown()) if isinstance(each, Gridded) else pa.float64()) for each in study.factors]
    columns += [(each.name, pa.bool_() if each.shares else pa.float64()) for each in study.measures]
    columns += [(name, pa.string()) for name in ("exit", "error", "commit", "digest")]
    return pa.schema(columns)


def parts(folder: Path) -> list[Path]:
    """The files of the data set, in order."""
    return sorted(folder.glob("part-*.parquet"))


def done(folder: Path) -> Iterable[tuple[int, str]]:
    """Numbers and ids of all rows of the data set."""
    import pyarrow.parquet as pq

    for path in parts(folder):
        table = pq.read_table(path, columns=["run", "id"])
        yield from zip(table["run"].to_pylist(), table["id"].to_pylist(), strict=True)


def write_data_set(folder: Path, study: Study, fresh: Callable[[], Iterable[dict[str, Any]]]) -> None:
    """Add rows to the data set; one that is there already is left as it is.

    Args:
        folder: of the data set.
        study: whose rows they are.
        fresh: gives the rows to add, anew each time that it is called.

    Raises:
        BadInput: a file cannot be written; those that were there are whole.
    """
    numbers = np.fromiter((row["run"] for row in fresh()), dtype=np.int64)
    for k in np.unique(numbers // PART).tolist():
        path = folder / f"part-{k:05d}.parquet"
        added = [row for row in fresh() if row["run"] // PART == k]
        _write_part(path, study, added)


def _write_part(path: Path, study: Study, added: list[dict[str, Any]]) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    schema = schema_of_rows(study)
    table = pa.Table.from_pylist(added, schema=schema)
    if path.is_file():
        table = pa.concat_tables([pq.read_table(path, schema=schema), table])
    order = np.unique(table["run"].to_numpy(), return_index=True)[1]  # the first of each run, in order
    whole_file(path, lambda place: pq.write_table(table.take(order), place))


def whole_file(path: Path, write: Callable[[Path], object]) -> None:
    """Write a file beside `path`, see it on the disk, and put it in its place.

    Raises:
        BadInput: that failed; `path` is as it was.
    """
    beside = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write(beside)
        with beside.open("rb") as file:
            os.fsync(file.fileno())
        beside.replace(path)
        folder = os.open(path.parent, os.O_RDONLY)
        os.fsync(folder)
        os.close(folder)
    except OSError as error:
        beside.unlink(missing_ok=True)
        raise BadInput(str(path), "", ABSENT, f"cannot be written ({error.strerror or error})") from None


def read_data_set(folder: Path) -> Any:
    """All rows as a table of pyarrow, in order."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    return pa.concat_tables([pq.read_table(path) for path in parts(folder)])
