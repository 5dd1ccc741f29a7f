from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.dataset
import pytest

from app.files.bad_input import BadInput
from app.studies import data_set
from app.studies.data_set import done, parts, read_data_set, schema_of_rows, whole_file, write_data_set
from app.studies.one_run import CaseOutcome
from app.studies.sweep import row_of
from tests.app.studies.study_fakes import plan


def made(*numbers: int) -> list[dict[str, Any]]:
    whole = plan()
    outcomes = [CaseOutcome(whole.case(k), (k / 3, k % 2 == 0), "ok") for k in numbers]
    return [row_of(whole.study, each) for each in outcomes]


def test_columns_have_the_kinds_of_their_values() -> None:
    schema = schema_of_rows(plan().study)
    kinds = {name: str(schema.field(name).type) for name in schema.names}
    assert kinds == {
        "run": "int64",
        "id": "string",
        "seed": "int64",
        "mass": "double",
        "height": "double",
        "sequence": "bool",
        "way": "double",
        "refused": "bool",
        "exit": "string",
        "error": "string",
        "commit": "string",
        "digest": "string",
    }


def test_the_rows_are_the_same_bytes_in_any_order(tmp_path: Path) -> None:
    orders = ([0, 1, 2, 3, 4, 5], [5, 0, 3, 1, 4, 2])
    for name, order in zip("ab", orders, strict=True):
        write_data_set(tmp_path / name, plan().study, lambda order=order: made(*order))
    write_data_set(tmp_path / "c", plan().study, lambda: made(4, 1))
    write_data_set(tmp_path / "c", plan().study, lambda: made(5, 3, 2, 0))
    a, b, c = (b"".join(path.read_bytes() for path in parts(tmp_path / name)) for name in "abc")
    assert a == b == c
    assert read_data_set(tmp_path / "a")["run"].to_pylist() == list(range(6))


def test_a_row_is_there_once(tmp_path: Path) -> None:
    write_data_set(tmp_path, plan().study, lambda: made(0, 1, 1))
    write_data_set(tmp_path, plan().study, lambda: made(1, 2))
    assert read_data_set(tmp_path)["run"].to_pylist() == [0, 1, 2]
    assert [number for number, _ in done(tmp_path)] == [0, 1, 2]


def test_a_large_study_has_several_files_and_opens_as_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(data_set, "PART", 4)
    write_data_set(tmp_path, plan().study, lambda: made(*range(10)))
    assert [path.name for path in parts(tmp_path)] == [f"part-0000{k}.parquet" for k in range(3)]
    table = pa.dataset.dataset(tmp_path).to_table().to_pandas()  # as pandas, polars and DuckDB do
    assert sorted(table["run"]) == list(range(10))


def test_nothing_is_a_null(tmp_path: Path) -> None:
    whole = plan()
    outcome = CaseOutcome(whole.case(0), (None, None), "error", "why")
    write_data_set(tmp_path, whole.study, lambda: [row_of(whole.study, outcome)])
    assert read_data_set(tmp_path).to_pylist()[0]["way"] is None


def test_a_file_that_cannot_be_written_leaves_the_old_one(tmp_path: Path) -> None:
    path = tmp_path / "f"
    path.write_text("old")

    def fails(place: Path) -> None:
        place.write_text("half")
        raise OSError(28, "No space left on device")

    with pytest.raises(BadInput, match="No space left"):
        whole_file(path, fails)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]
