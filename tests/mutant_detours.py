"""Takes the pendant's functions off mutmut's detours, which look at each call for the mutant and outlast most of what they call.

Where a mutant is tried, only its own function has to go round. Functions that somebody keeps elsewhere, in a table or a closure,
still do.
"""

import sys
from dataclasses import dataclass
from types import FunctionType

DETOUR = "_trampoline_wrapper"
"""What mutmut calls the functions that it puts in place of others."""


@dataclass(frozen=True)
class Detour:
    """One that stands in a module that uses it, or in a class."""

    owner: object
    """The module or class."""
    key: str
    """The owner's name for it."""
    function: FunctionType
    """What mutmut put there."""

    def put(self, mutant: str) -> None:
        """Leave the detour where it is of this mutant's function; let all others lead straight to the original."""
        setattr(self.owner, self.key, self.function if self.mutants == mutant.partition("__mutmut_")[0] else self.original)

    def put_back(self) -> None:
        """Let the owner go round again."""
        setattr(self.owner, self.key, self.function)

    @property
    def original(self) -> FunctionType:
        """What the detour stands for."""
        return self.function.__wrapped__  # type: ignore[attr-defined]

    @property
    def mutants(self) -> str:
        """How mutmut calls the mutants of the original, but for their number."""
        name = self.original.__qualname__
        mangled = "xǁ" + name.replace(".", "ǁ") if "." in name else f"x_{name}"
        return f"{self.original.__module__}.{mangled}"


def standing() -> list[Detour]:
    """All detours in what has been imported by now."""
    users = [user for key, user in sys.modules.items() if key.partition(".")[0] in ("pendant", "sim", "app", "tests")]
    classes = {value for user in users for value in vars(user).values() if isinstance(value, type)}
    return [
        Detour(owner, key, value)
        for owner in (*users, *(one for one in classes if one.__module__.startswith("pendant.")))
        for key, value in vars(owner).items()
        if isinstance(value, FunctionType) and value.__code__.co_name == DETOUR
    ]
