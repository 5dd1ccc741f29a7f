from pathlib import Path

from app.engine.source import digest_of, identity, source_commit, source_digest


def test_a_digest_is_of_names_and_bytes(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    found = [digest_of(tmp_path, ["a"])]
    for name, text in (("x.py", "1"), ("y.py", "1"), ("y.py", "2")):
        (tmp_path / "a" / name).write_text(text)
        found.append(digest_of(tmp_path, ["a"]))
    assert len(set(found)) == 4
    (tmp_path / "a" / "__pycache__").mkdir()
    (tmp_path / "a" / "__pycache__" / "x.pyc").write_text("left by Python")
    assert digest_of(tmp_path, ["a"]) == found[-1]


def test_a_process_says_what_it_runs() -> None:
    said = identity()
    assert said["source"] == source_digest()
    assert {"python", "mujoco", "numpy", "pinocchio"} <= said.keys()
    assert source_commit()
