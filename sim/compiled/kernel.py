"""Kernels: functions that numba compiles once and keeps on disk, from one start to the next."""

from collections.abc import Callable
from typing import Any

import numba


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function at its first call, or take it from the cache beside its file.

    Numba reads what types a cached kernel takes before it looks whether the source is still the same. So a named tuple that
    has another name since then would end the program: such an entry is thrown away here.
    """
    compiled: Any = numba.njit(cache=True)(function)
    cache: Any = getattr(compiled, "_cache", None)  # None where compiling is switched off
    if cache is not None:
        try:
            cache._cache_file._load_index()
        except (AttributeError, ImportError):
            cache.flush()
    return compiled
