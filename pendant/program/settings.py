"""The settings of programs."""

from typing import Annotated

from pendant.settings.schema import Section
from pendant.settings.schema import number as _number


class ProgramUse(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How programs run."""

    BASIC = ("speed",)

    speed: Annotated[
        float, _number(0.0, 1.0, "", "CD-15", text="share of its own speed at which a program moves; 0 halts it", locked=False)
    ] = 1.0
