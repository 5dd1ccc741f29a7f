"""What is installed only when it is asked for: `pip install 'pendant-sim[studies]'` and so on, by the packages that it brings."""

from importlib.util import find_spec

PACKAGES = {
    "network": ("starlette", "uvicorn"),
    "studies": ("dask", "distributed", "SALib", "pyarrow"),
    "report": ("matplotlib",),
    "learning": ("gymnasium", "av", "pyarrow"),
    "logs": ("mcap_ros2", "pyarrow"),
}
"""Extra -> the packages that one of its commands imports first."""

OF_COMMAND = {"export": "learning", "sweep": "studies"}
"""Command -> its extra, where a package is in several."""


def there(package: str) -> bool:
    """Whether a package is installed."""
    return find_spec(package) is not None


def to_install(module: str | None, command: str = "") -> str | None:
    """What to install for a module that is missing, in words; None: no extra has it.

    Args:
        module: its name, such as "pyarrow.csv".
        command: that needs it, such as "sweep"; empty: not known.
    """
    package = (module or "").partition(".")[0]
    having = [extra for extra, packages in PACKAGES.items() if package in packages]
    if not having:
        return None
    extra = OF_COMMAND.get(command, having[0])
    return f"needs {package}, which is not installed: pip install 'pendant-sim[{extra}]'"
