"""Records: arrays with names in one block of memory, which a compiled kernel takes as one argument.

Handing an array to a kernel costs as much as the arithmetic of a joint; a record of twenty arrays costs as much as one array.
"""

import numpy as np
from numpy.typing import NDArray

Record = NDArray[np.void]
"""One record (1,): in Python `record["name"][0]` is a view of an array, in a kernel `record[0].name` is the array."""


def record(**columns: tuple[int, ...] | str) -> Record:
    """A record of zeros. Each column is the shape of an array of floats, () for one float, or a type of numpy's such as "i8"."""
    types = [(name, column) if isinstance(column, str) else (name, "f8", column) for name, column in columns.items()]
    return np.zeros(1, np.dtype(types, align=True))
