"""The settings of tool and payload."""

from typing import Annotated

from pendant.settings.schema import Section
from pendant.settings.schema import number as _number


class ToolUse(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How tool and payload are changed and measured."""

    BASIC = ("ramp",)

    ramp: Annotated[
        float, _number(0.0, 10.0, "s", "tools", text="time in which the arm goes over to another payload", locked=False)
    ] = 1.0
    measure: Annotated[float, _number(0.1, 5.0, "s", "tools", text="time for which a posture is measured", locked=False)] = 0.5
    room: Annotated[
        float, _number(0.02, 0.5, "m", "tools", text="room that the wizard keeps free round the tool and its load", locked=False)
    ] = 0.1
    clearance: Annotated[
        float, _number(0.005, 0.2, "m", "tools", text="least distance as the wizard turns the wrist", locked=False)
    ] = 0.03
