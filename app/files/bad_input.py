"""Input that cannot be used: the one error that people see as a line, and commands end on with exit code 2."""


class BadInput(Exception):
    """Input that cannot be used. `str` is one line: where: field = value: what is allowed.

    Args:
        where: the file, option or message that holds the input.
        field: dotted path of the field; empty for the whole.
        value: what stands there; `ABSENT` for nothing.
        allowed: what may stand there.
    """

    def __init__(self, where: str, field: str, value: object, allowed: str) -> None:
        super().__init__(where, field, value, allowed)
        self.where = where
        self.field = field
        self.value = value
        self.allowed = allowed

    def __str__(self) -> str:
        what = [self.field] if self.field else []
        what += [] if self.value is ABSENT else [shown(self.value)]
        parts = [self.where, " = ".join(what), self.allowed]
        line = " ".join(": ".join(part for part in parts if part).split())
        return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in line)


class _Absent:
    def __repr__(self) -> str:
        return "nothing"

    def __reduce__(self) -> str:  # it is itself in other processes too
        return "ABSENT"


ABSENT = _Absent()
"""The value of a `BadInput` where there is none to show."""


def shown(value: object) -> str:
    """A value as one short line, in the words of a file: null, true, and quotes where a text could pass for something else."""
    if isinstance(value, bytes):
        text = value.decode("latin-1").encode("unicode_escape").decode()
    elif value is None or isinstance(value, bool):
        text = {None: "null", True: "true", False: "false"}[value]
    else:
        text = " ".join(str(value).split())
        if isinstance(value, str) and (not text or text in ("null", "true", "false") or text[0] in "+-.0123456789"):
            text = f"'{text}'"
    return text if len(text) <= 80 else f"{text[:77]}..."
