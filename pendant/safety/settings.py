"""Settings of the protective stops."""

from typing import Annotated

from pendant.settings.schema import Section
from pendant.settings.schema import number as _number
from pendant.settings.schema import switch as _switch


class FollowingSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How far the arm may be from its reference. Source of the tool's limit: ISO 13854, the least gap that crushes no finger."""

    BASIC = ("on",)

    on: Annotated[bool, _switch("RL-1", "an arm that does not follow its reference is stopped")] = True
    joint: Annotated[
        float,
        _number(0.2, 1.0, "", "RL-1", text="largest error of a joint, as a share of that at which it gives its rated torque"),
    ] = 0.6
    tool: Annotated[
        float, _number(0.005, 0.1, "m", "RL-1", text="largest distance of the tool centre point from where it should be")
    ] = 0.025
