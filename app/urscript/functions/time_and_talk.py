"""Functions that let time pass, and functions that show something to users (URScript manual, module internals)."""

from collections.abc import Generator, Iterator
from functools import partial

from app.urscript.language.trouble import Misuse
from app.urscript.machine.limits import LONGEST_TEXT
from app.urscript.machine.signature import Builtin, Taken, any_value, anything, boolean, builtin, integer, number, text, within
from app.urscript.machine.values import StructValue, Value, shown
from app.urscript.robot.robot_side import RobotSide
from pendant.tick.modes import TICK, TICK_RATE


def of_time(robot: RobotSide) -> Iterator[Builtin]:
    """sync, sleep, time."""

    def pause(t: float) -> Generator[None, None, None]:
        for _ in range(max(round(min(t, 1e6) * TICK_RATE), int(t > 0.0))):
            yield

    def one_tick() -> Generator[None, None, None]:
        yield

    def now(mode: int) -> StructValue:
        if mode == 1:
            raise Misuse("mode 1 is reserved")
        whole = int(robot.clock)
        return StructValue({"sec": whole, "nanosec": int((robot.clock - whole) * 1e9)})

    yield builtin("sync", one_tick, takes_time=True)
    yield builtin("sleep", pause, Taken("t", number), physical=True)
    yield builtin("get_steptime", lambda: TICK)
    yield builtin("time", now, Taken("mode", within(integer, 0, 2), 0))


def of_talk(robot: RobotSide) -> Iterator[Builtin]:
    """textmsg, popup, and questions to users."""

    def told(first: Value, second: Value) -> None:
        robot.say((shown(first) + shown(second))[:LONGEST_TEXT])

    def popup(*given: Value) -> Generator[None, None, None]:
        s, title, warning, error, blocking = given
        robot.popup(shown(s), title, "error" if error else "warning" if warning else "", blocking)
        while blocking and robot.popup_shown:
            yield

    for kind in ("boolean", "integer", "float", "string"):
        asked = partial(robot.question, kind)
        yield builtin(
            f"request_{kind}_from_primary_client", lambda s, ask=asked: ask(shown(s)), Taken("Text", anything), takes_time=True
        )
    yield builtin("textmsg", told, Taken("s1", any_value), Taken("s2", anything, ""))
    yield builtin(
        "popup",
        popup,
        Taken("s", anything),
        Taken("title", text, "Popup"),
        Taken("warning", boolean, False),
        Taken("error", boolean, False),
        Taken("blocking", boolean, False),
        takes_time=True,
    )
