"""Long scripts and the search for garbage: each look at a million objects would hold up the loop."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager

LONG = 10_000
"""Characters of a script whose objects are kept out of the search: of a shorter one they are looked through in milliseconds."""


@contextmanager
def uncollected(length: int) -> Iterator[None]:
    """No garbage is looked for meanwhile. What is there in the end is never looked at again where the script is long.

    So whoever made it has to see that it is no circle, and to let it go himself.

    Args:
        length: of the script [characters].
    """
    before, long = gc.isenabled(), length > LONG
    if long:
        gc.collect(1)  # what is garbage by now must not be kept
    gc.disable()
    try:
        yield
    finally:
        if long:
            gc.freeze()
        if before:
            gc.enable()
