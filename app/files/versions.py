"""What runs: the versions that a recording and a report name."""

import functools
import platform
from importlib.metadata import PackageNotFoundError, version

PACKAGES = {"pendant": "pendant-sim", "mujoco": "mujoco", "pinocchio": "pin", "numpy": "numpy"}
"""Name shown -> name of the distribution."""


@functools.cache
def versions() -> dict[str, str]:
    """Versions by name; `source tree` for what runs without being installed."""
    found = {"python": platform.python_version()}
    for name, package in PACKAGES.items():
        try:
            found[name] = version(package)
        except PackageNotFoundError:
            found[name] = "source tree"
    return found
