"""The files that an import may read: those of one folder, each of a bounded size."""

from pathlib import Path
from urllib.parse import unquote

from app.files.bad_input import ABSENT, BadInput
from app.files.regular_file import open_regular

LARGEST_XML = 5_000_000
"""Of a description of an arm, with all that it includes [bytes]."""

LARGEST_MESHES = 200_000_000
"""Of all meshes of an arm together [bytes]."""

PARENTS = 4
"""Folders above a file in which its package is looked for."""


class SourceFolder:
    """Reads what a description names, and remembers what was read.

    Args:
        file: the description.
        within: the folder that it may read; None: that of its package, where a folder above the file has a package.xml, else the
            file's own.

    Attributes:
        read: what was read, by its path below the folder.
    """

    def __init__(self, file: Path, within: Path | None = None) -> None:
        try:
            self.file = file.resolve()
            folder = (self.file.parent if within is None else within).resolve()
        except (OSError, RuntimeError, ValueError):  # a circle of links, a NUL, a name that is too long
            raise BadInput(str(file), "", ABSENT, "expected the name of a file") from None
        if within is None:
            above = [folder, *folder.parents][:PARENTS]
            folder = next((each for each in above if (each / "package.xml").is_file()), folder)
        self.folder = folder
        self.read: dict[Path, bytes] = {}
        self._left = {LARGEST_XML: LARGEST_XML, LARGEST_MESHES: LARGEST_MESHES}
        if not self.file.is_relative_to(folder):
            raise BadInput("--within", "", str(within), "expected a folder above the file")

    def text(self, path: Path, field: str) -> str:
        """A description, or a part of it. Raises BadInput: it cannot be read, is too large or not UTF-8."""
        data = self._bytes(path, field, LARGEST_XML)
        try:
            return data.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise BadInput(path.name, field, ABSENT, "expected XML in UTF-8") from None

    def mesh(self, path: Path, field: str) -> bytes:
        """A mesh. Raises BadInput: it cannot be read, or all of them are too large."""
        return self._bytes(path, field, LARGEST_MESHES)

    def find(self, name: str, beside: Path, field: str) -> Path:
        """The file that a description means.

        Args:
            name: as it stands there: a path, or `package://NAME/path`.
            beside: folder that a path is relative to.
            field: where it stands.

        Raises:
            BadInput: there is none, or it lies outside of the folder.
        """
        said = unquote(name)
        try:
            if said.startswith(("package://", "model://")):
                path = self._in_package(said.partition("://")[2], name, field)
            elif "://" in said and not said.startswith("file://"):
                raise BadInput(self.file.name, field, name, "expected a path, or package://NAME/path")
            else:
                path = (beside / said.removeprefix("file://")).resolve()
            if not path.is_relative_to(self.folder):
                raise self._outside(name, field)
            there = path.is_file()
        except (OSError, RuntimeError, ValueError):
            raise BadInput(self.file.name, field, name, "expected the name of a file") from None
        if not there:
            raise BadInput(self.file.name, field, name, "expected an existing file")
        return path

    def _in_package(self, said: str, name: str, field: str) -> Path:
        package, _, rest = said.partition("/")
        for above in (self.file.parent, *self.file.parents[1:]):
            for root in (above, above / package):
                if root.name == package and root.is_dir() and root.resolve().is_relative_to(self.folder):
                    return (root / rest).resolve()
        raise BadInput(
            self.file.name, field, name, f"expected a package below {self.folder}; --within names the folder to look in"
        )

    def _outside(self, name: str, field: str) -> BadInput:
        allowed = f"is outside of {self.folder}, and nothing is read there; --within names a wider folder"
        return BadInput(self.file.name, field, name, allowed)

    def _bytes(self, path: Path, field: str, largest: int) -> bytes:
        if path in self.read:
            return self.read[path]
        left, data = self._left[largest], bytearray()
        with open_regular(path) as file:
            while len(data) <= left and (part := file.read(left + 1 - len(data))):
                data += part
        if len(data) > left:
            raise BadInput(path.name, field, ABSENT, f"expected files of their kind of at most {largest} bytes together")
        self._left[largest] -= len(data)
        self.read[path] = bytes(data)
        return self.read[path]
