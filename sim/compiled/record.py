"""Records: arrays with names in one block of memory, which a compiled kernel takes as one argument.

Handing an array to a kernel costs as much as the arithmetic of a joint; a record of twenty arrays costs as much as one array.
One value of it costs Python five times as much by `record[0]["name"]` as by `record["name"].item()` of a kept `record["name"]`.
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray

Record = NDArray[np.void]
"""One record (1,): in Python `record["name"][0]` is a view of an array, in a kernel `record[0].name` is the array."""

Column = tuple[str, str] | tuple[str, str, tuple[int, ...]]


def record(**columns: tuple[int, ...] | str) -> Record:
    """A record of zeros. Each column is the shape of an array of floats, () for one float, or a type of numpy's such as "i8"."""
    return np.zeros(
        1, _layout(tuple((name, column) if isinstance(column, str) else (name, "f8", column) for name, column in columns.items()))
    )


@cache
def _layout(columns: tuple[Column, ...]) -> "np.dtype[np.void]":
    """Records of the same columns share one object, for each call of a kernel looks its record's layout up.

    An equal layout that is another object is compared column by column then: 0.03 ms a tick for every arm but the first.
    """
    return np.dtype(list(columns), align=True)
