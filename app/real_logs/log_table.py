"""Tables of numbers as text: which sign parts the columns, whether there is a header, and the columns that are wanted."""

import re
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from pyarrow import csv

from app.files.bad_input import ABSENT, BadInput
from app.real_logs.joint_log import counted
from app.real_logs.log_columns import ColumnMap, by_header, by_map

Array = NDArray[np.float64]

HEAD = 65_536
"""So much of a file is looked at to find its form [bytes]."""
BROKEN_SHARE = 0.2
"""Largest share of lines that may be broken: of a table of which more is, nobody knows what the rest means."""
NO_NUMBER = ["", "nan", "NaN", "NAN", "null", "NULL", "NA", "N/A", "-", "inf", "-inf", "Inf", "-Inf"]


def read_table(path: Path, columns: str | None, n: int) -> tuple[ColumnMap, dict[str, Array], list[str]]:
    """Read the columns of a table that are wanted.

    Args:
        path: of the file.
        columns: as `--columns`; None: the file has a header of RTDE names.
        n: joints of the arm.

    Returns:
        The map, the columns of each quantity (k, width), and what was mended, a sentence each. What is no number is NaN.

    Raises:
        BadInput: it is no such table, in one line.
    """
    where = path.name
    parting, decimal, names, skip = _form(path)
    if columns is not None:
        found = by_map(columns, n)
    elif names is None:
        raise BadInput(where, "", ABSENT, "has no header; say what its columns are, such as --columns t,q,qd,current")
    else:
        found = by_header(names, n, where)
    width = len(names) if names is not None else _width(path, parting, skip)
    last = max(max(places) for places in found.places.values()) if found.places else -1
    if last >= width:
        raise BadInput(where, "--columns", ABSENT, f"{last + 1} columns are named, and the table has {width}")
    table, broken = _read(path, parting=parting, decimal=decimal, skip=skip, width=width, found=found)
    if broken > BROKEN_SHARE * (broken + table.num_rows):
        raise BadInput(where, "", ABSENT, f"{broken} of {broken + table.num_rows} lines do not have {width} columns")
    told = [f"{counted(broken, 'line')} with another number of columns left out"] if broken else []
    out = dict[str, Array]()
    for name, places in found.places.items():  # one after the other: an hour is a quarter of a gigabyte
        columns_of = [f"c{place}" for place in places]
        out[name] = np.column_stack([table.column(each).to_numpy(zero_copy_only=False) for each in columns_of])
        table = table.drop_columns(columns_of)
    return found, out, told


def _form(path: Path) -> tuple[str, str, list[str] | None, int]:
    """The sign between columns, the decimal sign, the header if there is one, and the lines before the first row."""
    try:
        with path.open("rb") as file:
            head = file.read(HEAD)
    except OSError as error:
        raise BadInput(path.name, "", ABSENT, f"cannot be read: {error.strerror}") from None
    if not head.strip():
        raise BadInput(path.name, "", ABSENT, "is empty; expected a log of an arm")
    if b"\0" in head:
        raise BadInput(path.name, "", ABSENT, "is no table of text; expected CSV, or a recording or bag that ends with .mcap")
    lines = head.decode("utf-8-sig", "replace").splitlines()
    if len(head) == HEAD:
        lines = lines[:-1]  # it may be cut
    skip, names = 0, None
    for line in lines:
        if line.strip() and not line.lstrip().startswith(("#", "%", "//")):
            break
        skip += 1
    if skip == len(lines):
        raise BadInput(path.name, "", ABSENT, "has no row; expected a log of an arm")
    first = lines[skip]
    parting = max(";\t, ", key=lambda sign: (first.strip().count(sign), sign != " "))
    if not _numbers(first, parting):
        names, skip = first.strip().split(parting), skip + 1
    rows = [line for line in lines[skip:] if line.strip()]
    if not rows:
        raise BadInput(path.name, "", ABSENT, "has a header and no row")
    if names is not None and not _numbers(rows[0], parting):
        raise BadInput(path.name, f"line {skip + 1}", rows[0][:40], "expected numbers below the header")
    decimal = "," if parting == ";" and "," in rows[0] else "."
    return parting, decimal, names, skip


def _numbers(line: str, parting: str) -> bool:
    """Whether most of the cells of a line are numbers: a gap in a row does not make it a header."""
    cells = [cell.strip().strip('"') for cell in line.strip().split(parting)]
    return sum(bool(re.fullmatch(r"[-+]?(\d+([.,]\d*)?|[.,]\d+)([eE][-+]?\d+)?", cell)) for cell in cells) > len(cells) / 2


def _width(path: Path, parting: str, skip: int) -> int:
    """Columns that most of the first rows have."""
    with path.open("rb") as file:
        lines = file.read(HEAD).decode("utf-8-sig", "replace").splitlines()[skip:]
    counts = [_one_space(line, parting).count(parting) + 1 for line in lines[:200] if line.strip()]
    return int(np.bincount(counts).argmax())


def _one_space(line: str, parting: str) -> str:
    return re.sub(" +", " ", line.strip()) if parting == " " else line


def _read(path: Path, *, parting: str, decimal: str, skip: int, width: int, found: ColumnMap) -> tuple[pa.Table, int]:
    broken = 0

    def leave_out(_row: csv.InvalidRow) -> str:
        nonlocal broken
        broken += 1
        return "skip"

    wanted = [f"c{place}" for places in found.places.values() for place in places]
    source: Path | pa.BufferReader = path
    if parting == " ":  # columns that are set out by several spaces
        lines = path.read_text("utf-8-sig", "replace").splitlines()
        source = pa.BufferReader("\n".join(_one_space(line, parting) for line in lines).encode())
    try:
        table = csv.read_csv(
            source,
            read_options=csv.ReadOptions(
                column_names=[f"c{k}" for k in range(width)], skip_rows=skip, use_threads=False, encoding="latin-1"
            ),
            parse_options=csv.ParseOptions(delimiter=parting, invalid_row_handler=leave_out),
            convert_options=csv.ConvertOptions(
                column_types={name: pa.float64() for name in wanted},
                include_columns=wanted,
                null_values=NO_NUMBER,
                decimal_point=decimal,
            ),
        )
    except pa.ArrowInvalid as error:
        value = re.search(r"invalid value '([^']*)'", str(error))
        row = re.search(r"Row #(\d+)", str(error))
        line = f"line {int(row[1])}" if row else ""
        raise BadInput(path.name, line, value[1] if value else ABSENT, "expected a number") from None
    return table, broken
