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
        shown = "" if self.value is ABSENT else f" = {_shown(self.value)}" if self.field else f" {_shown(self.value)}"
        return " ".join(f"{self.where}: {self.field}{shown}: {self.allowed}".replace(": :", ":").split())


class _Absent:
    def __repr__(self) -> str:
        return "nothing"


ABSENT = _Absent()
"""The value of a `BadInput` where there is none to show."""


def _shown(value: object) -> str:
    text = value.decode("latin-1").encode("unicode_escape").decode() if isinstance(value, bytes) else str(value)
    text = " ".join(text.split()) if text.strip() else repr(text)
    return text if len(text) <= 80 else f"{text[:77]}..."
