"""The settings of the free arm's watches."""

from typing import Annotated

from pendant.settings.schema import Section
from pendant.settings.schema import number as _number
from pendant.settings.schema import switch as _switch


class Unexplained(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Motion that nobody causes, and payloads that drop or change, are STOP."""

    motion: Annotated[bool, _switch("FD-19", "motion in free-drive that nobody causes is STOP")] = True
    payload: Annotated[bool, _switch("FD-19", "a payload that drops or changes in free-drive is STOP")] = True
    speed: Annotated[float, _number(0.005, 0.25, "m/s", "FD-19", text="of the flange, from which on it counts as moving")] = 0.02
    time: Annotated[float, _number(0.02, 2.0, "s", "FD-19", text="that it may move alone")] = 0.3
    force: Annotated[float, _number(0.5, 20.0, "N", "FD-19", text="a smaller force does not count as a user force")] = 1.0
    sensor: Annotated[bool, _switch("FD-19", "a flange sensor that drifts or steps drives no arm")] = True
