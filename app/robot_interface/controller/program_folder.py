"""The programs that a client can load by name: YAML files of steps in one folder, and those that come with the product."""

from pathlib import Path

import msgspec

from app.files.bad_input import BadInput
from app.files.checked import load
from app.files.library import ASSETS
from pendant.program.steps import Program

BUNDLED = ASSETS / "programs"


class ProgramFolder:
    """Names end in .urp, as clients write them; what a client calls P.urp is the YAML file of that name.

    Args:
        folder: the user's, looked at first; None for the bundled ones alone.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self._folders = [BUNDLED] if folder is None else [folder, BUNDLED]

    def names(self) -> list[str]:
        """All of them, sorted."""
        return sorted({f"{path.stem}.urp" for folder in self._folders for path in folder.glob("*.yaml")})

    def find(self, name: str) -> Path | None:
        """The file of a program; None: there is none, or the name leads out of the folder."""
        stem = name.removeprefix("/programs/").removesuffix(".urp")
        if not stem or stem != Path(stem).name or not stem.isprintable():
            return None
        return next((path for folder in self._folders if (path := folder / f"{stem}.yaml").is_file()), None)

    def load(self, path: Path) -> Program:
        """The program in a file of `find`, by the name of its file.

        Raises:
            BadInput: it is no program.
        """
        return msgspec.structs.replace(load(path, Program), name=path.stem)


__all__ = ["BUNDLED", "BadInput", "ProgramFolder"]
