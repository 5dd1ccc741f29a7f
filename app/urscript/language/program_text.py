"""Cuts what a client sends into programs: a program ends at its `end`, as on the robot; other lines are programs of their own."""

import re

OPENS = re.compile(r"\b(?:def|sec|thread|if|while|critical)\b")
CLOSES = re.compile(r"\bend\b")
QUIET = re.compile(r"\"[^\"]*\"|'[^']*'|#.*|^\s*\$.*")

LONGEST = 1 << 20
"""Of a program [bytes]."""


FUNCTION = re.compile(r"\s*(?:(?:#|\$)[^\n]*\n\s*)*(?:def|sec)\b")
"""How a text begins that the network would cut at each `end`."""


def programs_of(text: str) -> list[str]:
    """The programs of a text as the network cuts it, where it begins with a function; else the text is one program.

    Lines that stand alone behind a function, a call of it say, are programs of their own.
    """
    if FUNCTION.match(text) is None:
        return [text]
    cut = ProgramText()
    found = cut.hear(text.encode() + b"\n")
    if found is None:
        return [text]
    return [*found, cut.all()] if cut.unfinished else found


class ProgramText:
    """What one client has sent so far."""

    def __init__(self) -> None:
        self._left = b""
        self._lines: list[str] = []
        self._depth = 0
        self._size = 0

    @property
    def unfinished(self) -> bool:
        """A program has begun, and its end has not come."""
        return bool(self._lines)

    def hear(self, data: bytes) -> list[str] | None:
        """The programs, and single lines, that are whole by now; None: a line or a program is too long."""
        *lines, self._left = (self._left + data).split(b"\n")
        found: list[str] = []
        for line in lines:
            self._size += len(line) + 1
            text = line.decode("utf-8", "replace").rstrip("\r")
            if not self._lines and not text.strip():
                self._size = 0
                continue
            self._lines.append(text)
            bare = QUIET.sub("", text)
            self._depth += len(OPENS.findall(bare)) - len(CLOSES.findall(bare))
            self._depth += 1000 * (sum(bare.count(c) for c in "([") - sum(bare.count(c) for c in ")]"))
            if self._depth <= 0 and bare.strip():
                found.append(self.all())
        return None if self._size + len(self._left) > LONGEST else found

    def all(self) -> str:
        """What has been sent of a program, whole or not; it is forgotten here."""
        text = "\n".join(self._lines)
        self._lines, self._depth, self._size = [], 0, 0
        return text
