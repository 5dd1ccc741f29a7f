"""An imported arm on the disk: arm file, pictures, tool, and what it came from."""

import contextlib
import os
import shutil
import tempfile
from pathlib import Path

import msgspec
import yaml

from app.arm_import.importing import Imported
from app.files.bad_input import BadInput
from app.files.library import MESHES

SOURCE = "source"
"""Folder of the originals."""


def written(found: Imported, file: Path, folder: Path) -> Path:
    """Write an imported arm into a folder of its name below `folder`, all of it or nothing; what an import wrote there before is
    replaced. The path of the arm file.

    Args:
        found: the arm.
        file: the description that it came from.
        folder: of arms.

    Raises:
        BadInput: it cannot be written, or something else is there.
    """
    name = found.arm.name
    target = folder / name
    if target.exists() and not (target / f"{name}.yaml").is_file():
        raise BadInput("--out", "", str(target), "expected a folder of an import, or none of this name")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder, prefix=f".{name}-") as scratch:
            new, old = Path(scratch) / "new", Path(scratch) / "old"
            (new / MESHES).mkdir(parents=True)
            _fill(new, found, file)
            if target.exists():
                target.replace(old)
            try:
                new.replace(target)
            except OSError:
                with contextlib.suppress(OSError):
                    old.replace(target)
                raise
            shutil.rmtree(old, ignore_errors=True)
    except OSError as error:
        raise BadInput("--out", "", str(folder), f"cannot be written: {error.strerror}") from None
    return target / f"{name}.yaml"


def _fill(folder: Path, found: Imported, file: Path) -> None:
    name = found.arm.name
    head = [
        f"# {name}, written by `pendant import` from {file.name}. SI units, radians. Fields: sim/arm/arm_file.py.",
        *(f"# {line}" for line in found.told),
        "# Measure first, and give it to `pendant import --measured`:",
        *(f"#   {field}: {does}" for field, does in found.assumed),
    ]
    text = "\n".join(" ".join(line.splitlines()) for line in head) + "\n" + text_of_arm(found)
    (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    for part, data in found.pictures.items():
        (folder / MESHES / f"{part}.glb").write_bytes(data)
    if found.tool is not None:
        (folder / f"{found.tool.name}.yaml").write_text(_yaml(found.tool), encoding="utf-8")
        cell = {"robot": f"{name}.yaml", "tool": f"{found.tool.name}.yaml"}
        (folder / "cell.yaml").write_text(yaml.safe_dump(cell, sort_keys=False), encoding="utf-8")
    common = os.path.commonpath([path.parent for path in found.originals])
    for path, data in found.originals.items():
        kept = folder / SOURCE / path.relative_to(common)
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_bytes(data)


def text_of_arm(found: Imported) -> str:
    """The arm as the text of its file."""
    return _yaml(found.arm)


def _yaml(value: msgspec.Struct) -> str:
    plain = msgspec.to_builtins(value)
    return yaml.safe_dump(plain, sort_keys=False, width=120, default_flow_style=None, allow_unicode=True)
