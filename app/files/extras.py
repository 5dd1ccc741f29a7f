"""What is installed only when it is asked for: `pip install 'pendant-sim[studies]'` and so on, by the packages that it brings."""

from importlib.util import find_spec

PACKAGES = {
    "network": ("starlette", "uvicorn"),
    "report": ("matplotlib",),
    "studies": ("dask", "distributed", "SALib", "pyarrow", "matplotlib"),
    "learning": ("gymnasium", "av", "pyarrow"),
    "logs": ("mcap_ros2", "pyarrow", "matplotlib"),
}
"""Extra -> the packages that one of its commands imports first."""

OF_COMMAND = {"against": "logs", "export": "learning", "fit": "logs", "sweep": "studies"}
"""Command -> its extra, which counts where a package is in several; else the first that has it."""


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
    extra = OF_COMMAND.get(command)
    extra = extra if extra in having else having[0]
    return f"needs {package}, which is not installed: pip install 'pendant-sim[{extra}]'"
