"""Whether Python finds the product's own folders: `app`, `sim`, `pendant` and `assets` are names that other projects use, too."""

import sys
from importlib.machinery import PathFinder
from pathlib import Path

FOLDERS = ("app", "pendant", "sim", "assets")


def hidden() -> str | None:
    """What hides a folder of the product, in one line; None: nothing does."""
    here = Path(__file__).resolve().parent.parent
    for name in FOLDERS:
        found = getattr(sys.modules.get(name), "__spec__", None) or PathFinder.find_spec(name)
        places = [] if found is None else [*(found.submodule_search_locations or [found.origin or ""])]
        if found is not None and here / name not in [Path(place).resolve() for place in places]:
            where = f"{places[0]}" if places else "another package"
            return f"{where} hides the package {name!r} of pendant-sim; start where Python does not find it first, or rename it"
    return None
