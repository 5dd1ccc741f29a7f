"""The settings of virtual walls."""

from typing import Annotated

from pendant.settings.schema import Section
from pendant.settings.schema import number as _number
from pendant.settings.schema import switch as _switch


class WallSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Virtual walls: those of the session, and the tether, a sphere round the flange that follows the user's hand."""

    on: Annotated[bool, _switch("FD-24", "walls and areas hold")] = True
    anew: Annotated[bool, _switch("VW-3", "walls get new anchors by their policies")] = True
    sizes: Annotated[bool, _switch("VW-8", "sizes follow posture or payload, or the smallest holds")] = True
    resistance: Annotated[bool, _switch("VW-7", "walls resist before they are reached")] = True
    tether: Annotated[bool, _switch("VW-4", "a sphere round the flange follows the hand")] = True
    activation_radius: Annotated[float, _number(0.001, 0.1, "m", "VW-6", text="of the tether in the activation sequence")] = 0.005
    operation_radius: Annotated[
        float, _number(0.005, 1.0, "m", "VW-6", text="of the tether in free-drive; the arm stops at it")
    ] = 0.03
    band: Annotated[float, _number(0.0, 0.5, "m", "VW-7", text="before the tether, where it resists")] = 0.005
    averaging: Annotated[float, _number(0.02, 10.0, "s", "VW-4", text="the tether lies round the flange's mean place")] = 0.02
    safety_period: Annotated[
        float, _number(0.1, 10.0, "s", "VW-3", text="the tether follows a hand that was felt so long ago")
    ] = 1.0
    push_back: Annotated[float, _number(1.0, 50.0, "N", "VW-5", text="smallest force that the tether takes for a hand's")] = 1.0
    leave: Annotated[bool, _switch("VW-6", "beyond the tether, free-drive is left")] = False
    stop: Annotated[bool, _switch("VW-6", "beyond the tether is STOP")] = False
