"""The settings of the free arm's watches."""

from typing import Annotated

from pendant.settings.schema import Section
from pendant.settings.schema import number as _number
from pendant.settings.schema import switch as _switch


class Unexplained(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Motion that nobody causes, and payloads that drop or change, are STOP."""

    BASIC = ("motion", "payload")

    motion: Annotated[bool, _switch("FD-19", "motion in free-drive that no hand causes is a STOP")] = True
    payload: Annotated[bool, _switch("FD-19", "a payload that drops or changes in free-drive is a STOP")] = True
    speed: Annotated[float, _number(0.005, 0.25, "m/s", "FD-19", text="the flange counts as moving from this speed on")] = 0.02
    time: Annotated[float, _number(0.02, 2.0, "s", "FD-19", text="time for which it may move without a hand")] = 0.3
    distance: Annotated[
        float, _number(0.002, 0.1, "m", "FD-19", text="an arm at rest that nobody touches goes no farther, however slowly")
    ] = 0.015
    force: Annotated[float, _number(0.5, 20.0, "N", "FD-19", text="a force below this does not count as a hand's")] = 1.0
    sensor: Annotated[bool, _switch("FD-19", "a flange sensor that drifts or steps does not move the arm")] = True
