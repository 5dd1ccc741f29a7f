"""Forces that a person may bear, by body region: data with a source each, in assets/limits/."""

import msgspec

from app.files.checked import load
from app.files.library import ASSETS
from pendant.settings.bounds import Positive


class Region(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Limits of one body region."""

    region: str
    quasi_static: Positive  # held [N]
    transient: Positive | None  # at its peak [N]; None: no transient contact is allowed
    source: str


class Regions(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The file."""

    title: str
    regions: list[Region]


def regions() -> Regions:
    """The limits that ship.

    Raises:
        BadInput: the file was edited into something else.
    """
    return load(ASSETS / "limits" / "body-regions.yaml", Regions)
