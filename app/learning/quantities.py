"""Spaces of numbers with names and units, for observations and actions."""

from typing import NamedTuple

import gymnasium
import numpy as np
from numpy.typing import NDArray


class Quantity(NamedTuple):
    """Numbers of one kind."""

    name: str
    size: int
    unit: str
    low: tuple[float, ...]  # (size,) lower bounds
    high: tuple[float, ...]  # (size,) upper bounds
    text: str  # what it is, and in which frame


def even(name: str, bounds: tuple[float, ...], unit: str, text: str) -> Quantity:
    """A quantity with symmetric bounds: -bounds to bounds."""
    return Quantity(name, len(bounds), unit, tuple(-bound for bound in bounds), bounds, text)


class QuantityBox(gymnasium.spaces.Box):
    """A box of float32 whose numbers have names and units.

    Attributes:
        quantities: in the order of the numbers.
    """

    def __init__(self, quantities: tuple[Quantity, ...]) -> None:
        low = np.array([bound for each in quantities for bound in each.low], dtype=np.float32)
        high = np.array([bound for each in quantities for bound in each.high], dtype=np.float32)
        super().__init__(low, high, dtype=np.float32)
        self.quantities = quantities

    def __repr__(self) -> str:
        return f"QuantityBox({', '.join(f'{each.name}[{each.size}] {each.unit}' for each in self.quantities)})"

    def part(self, name: str) -> slice:
        """Where the numbers of a quantity are.

        Raises:
            KeyError: there is no quantity of that name.
        """
        begin = 0
        for each in self.quantities:
            if each.name == name:
                return slice(begin, begin + each.size)
            begin += each.size
        raise KeyError(f"{name!r}: there are {', '.join(each.name for each in self.quantities)}")

    def within(self, *parts: NDArray[np.float64]) -> NDArray[np.float32]:
        """The parts in one array (k,), each number within its bounds."""
        return np.clip(np.concatenate(parts), self.low, self.high, dtype=np.float32, casting="same_kind")
