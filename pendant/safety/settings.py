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


class CollisionSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """With which force the arm may meet something. Source of the clamping force: the third of a UR's four presets of limits."""

    BASIC = ("on", "force")

    on: Annotated[bool, _switch("RL-3", "an arm that hits something is stopped")] = True
    force: Annotated[
        float, _number(20.0, 250.0, "N", "RL-3", text="force on tool or link at which a moving arm takes it for a collision")
    ] = 50.0
    clamping: Annotated[
        float,
        _number(50.0, 250.0, "N", "RL-3", text="the same of an arm that stands, and where a program asked for contact"),
    ] = 150.0
