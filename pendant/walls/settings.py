"""The settings of virtual walls."""

from typing import Annotated

from pendant.settings.schema import Section
from pendant.settings.schema import choice as _choice
from pendant.settings.schema import number as _number
from pendant.settings.schema import switch as _switch
from pendant.tick.words import Word


class Reaction(Word):
    """What follows when a wall is exceeded in FREE_DRIVE (VW-6). In the activation sequence entry is refused (FD-10)."""

    STAY = "stay"  # free-drive goes on; the arm stops at the wall and stays there
    LEAVE = "leave"  # free-drive ends: it is kept only while the part is inside (P 84)
    STOP = "stop"


class WallSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Virtual walls: those of the session, and the tether, a sphere round the flange that follows the user's hand."""

    BASIC = ("on", "resistance", "tether", "operation_radius", "tether_reaction")

    on: Annotated[bool, _switch("FD-24", "virtual walls and areas are active")] = True
    new_anchors: Annotated[bool, _switch("VW-3", "walls may move with what they are fixed to, each by its policy")] = True
    sizes: Annotated[bool, _switch("VW-8", "sizes of walls follow posture or payload; otherwise the smallest holds")] = True
    resistance: Annotated[bool, _switch("VW-7", "walls resist the arm before it reaches them")] = True
    tether: Annotated[bool, _switch("VW-4", "a sphere round the flange, the tether, follows the user's hand")] = True
    activation_radius: Annotated[
        float, _number(0.001, 0.1, "m", "VW-6", text="radius of the tether in the activation sequence")
    ] = 0.005
    operation_radius: Annotated[
        float, _number(0.005, 1.0, "m", "VW-6", text="radius of the tether in free-drive; the arm stops at it")
    ] = 0.03
    band: Annotated[
        float, _number(0.0, 0.5, "m", "VW-7", text="width of the band before the tether in which the arm is resisted")
    ] = 0.005
    push: Annotated[
        float, _number(0.0, 100.0, "N", "VW-7", text="push of the tether back inwards, at rest, too; it grows through the band")
    ] = 0.0
    averaging: Annotated[float, _number(0.02, 10.0, "s", "VW-4", text="time over which the tether's centre is averaged")] = 0.02
    safety_period: Annotated[
        float, _number(0.1, 10.0, "s", "VW-3", text="time after a felt hand in which the tether still follows")
    ] = 1.0
    push_back: Annotated[float, _number(1.0, 50.0, "N", "VW-5", text="smallest force that counts as a hand's for the tether")] = (
        1.0
    )
    tether_reaction: Annotated[Reaction, _choice("VW-6", "what follows when the tether is exceeded")] = Reaction.STAY
