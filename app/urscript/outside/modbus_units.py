"""All Modbus units and signals of one robot, which programs add and delete."""

from collections.abc import Callable, Sequence

from app.urscript.language.trouble import Misuse
from app.urscript.outside.hosts import SHOWN
from app.urscript.outside.modbus_client import AbsentUnit, ModbusSignal, ModbusUnit, UnitPlace

MOST_SIGNALS = 200
MOST_UNITS = 16

Unit = ModbusUnit | AbsentUnit


class ModbusUnits:
    """All units and signals of one robot. They stay when a program ends, as on a robot.

    Args:
        clock: tells the robot's [s].
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._units: dict[UnitPlace, Unit] = {}
        self._signals: dict[str, tuple[Unit, ModbusSignal]] = {}
        self._clock = clock

    def add(self, place: UnitPlace, signal: ModbusSignal) -> None:
        """Supervise a signal; one of the same name is replaced. Raises Misuse: there are too many."""
        self.delete(signal.name)
        unit = self._units.get(place)
        if len(self._signals) >= MOST_SIGNALS or (unit is None and len(self._units) >= MOST_UNITS):
            raise Misuse(f"more than {MOST_SIGNALS} signals, or {MOST_UNITS} units")
        if unit is None:
            unit = self._units[place] = ModbusUnit(place) if place.allowed else AbsentUnit(place)
            unit.start()
        signal.seen = self._clock()
        signal.values = (0,) * signal.count
        unit.signals = (*unit.signals, signal)
        self._signals[signal.name] = unit, signal
        unit.hurry()

    def delete(self, name: str) -> None:
        """Supervise a signal no more; one that there is not, is none."""
        found = self._signals.pop(name, None)
        if found is not None:
            unit, signal = found
            unit.signals = tuple(each for each in unit.signals if each is not signal)
            if not unit.signals:
                unit.end()
                del self._units[unit.place]

    def signal(self, name: str) -> ModbusSignal:
        """A signal. Raises Misuse: there is none of this name."""
        if name not in self._signals:
            raise Misuse(f"signal_name: there is no signal {name[:20]!r}")
        return self._signals[name][1]

    def place(self, name: str) -> UnitPlace:
        """Where the unit of a signal is. Raises Misuse: there is no signal of this name."""
        self.signal(name)
        return self._signals[name][0].place

    def read(self, name: str) -> tuple[int, ...]:
        """What a signal was when it was in order last.

        Raises:
            Misuse: there is none of this name, or it has been out of order for longer than it may be.
        """
        signal = self.signal(name)
        if self.invalid_for(signal) > signal.watchdog:
            raise Misuse(self._problem(*self._signals[name]))
        return signal.values

    def __contains__(self, name: str) -> bool:
        return name in self._signals

    def invalid_for(self, signal: ModbusSignal) -> float:
        """For how long a signal has been out of order [s]."""
        return 0.0 if signal.valid else self._clock() - signal.seen

    def write(self, name: str, values: Sequence[int], *, lasting: bool = False) -> None:
        """Have an output written as soon as its unit is free; one that is not there is not written later, unless `lasting`."""
        unit, signal = self._signals[name]
        signal.lasting, signal.wanted = lasting, tuple(values)
        unit.hurry()

    def refresh(self, name: str) -> None:
        """Read a signal as soon as its unit is free."""
        unit, signal = self._signals[name]
        signal.due = 0.0
        unit.hurry()

    def units_at(self, place: UnitPlace) -> list[Unit]:
        """Those at an address, at whatever port."""
        return [unit for at, unit in self._units.items() if (at.address, at.allowed) == (place.address, place.allowed)]

    def step(self) -> str:
        """One tick of the robot; what people have not been told of a signal, or of all signals of a unit, in words, or ""."""
        clock = self._clock()
        late: tuple[Unit, ModbusSignal] | None = None
        for unit, signal in self._signals.values():
            if signal.valid:
                signal.seen = clock
            elif late is None and not signal.told and clock - signal.seen > signal.watchdog:
                late = unit, signal
        if late is None:
            return ""
        unit, signal = late
        for each in (signal,) if signal.connected else unit.signals:
            each.told = True
        return self._problem(unit, signal)

    def _problem(self, unit: Unit, signal: ModbusSignal) -> str:
        host = f"{unit.place.address[:SHOWN]}:{unit.place.port}"
        why = f"exception {signal.device_error}" if signal.connected else f"no answer from {host}"
        return f"Modbus signal {signal.name}: {why} for {signal.watchdog:g} s"

    @property
    def used(self) -> bool:
        """There are signals."""
        return bool(self._signals)

    def end(self) -> None:
        """Supervise nothing any more."""
        for name in list(self._signals):
            self.delete(name)
