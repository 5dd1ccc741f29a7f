"""Functions of numbers, lists and poses (URScript manual, module urmath)."""

import math
import random as chance
from collections.abc import Iterator

from app.urscript.calculation import pose_algebra as algebra
from app.urscript.language.trouble import Misuse
from app.urscript.machine.operators import NUMBERS
from app.urscript.machine.signature import (
    Builtin,
    Taken,
    any_value,
    anything,
    builtin,
    integer,
    items,
    number,
    numbers,
    pose,
    vector,
    within,
)
from app.urscript.machine.values import GREATEST, PoseValue, Value, kind, made_list


def of_numbers(seed: int) -> Iterator[Builtin]:
    """All of them; `seed` of what random() gives."""
    source = chance.Random(seed)
    f, x, p = Taken("f", number), Taken("x", number), Taken("v", anything)
    for name, work in {"sin": math.sin, "cos": math.cos, "tan": math.tan, "atan": math.atan}.items():
        yield builtin(name, work, f)
    yield builtin("acos", math.acos, Taken("f", within(number, -1.0, 1.0)))
    yield builtin("asin", math.asin, Taken("f", within(number, -1.0, 1.0)))
    yield builtin("atan2", math.atan2, x, Taken("y", number))
    yield builtin("sqrt", math.sqrt, Taken("f", within(number, 0.0, math.inf)))
    yield builtin("pow", _power, Taken("base", number), Taken("exponent", number))
    yield builtin("log", _logarithm, Taken("b", number), f)
    yield builtin("floor", lambda value: _whole(math.floor(value)), f)
    yield builtin("ceil", lambda value: _whole(math.ceil(value)), f)
    yield builtin("round", lambda value: _whole(math.floor(value + 0.5)), f)
    yield builtin("abs", lambda value: abs(value) if type(value) in NUMBERS else _no_number(value), Taken("f", any_value))
    yield builtin("d2r", math.radians, Taken("d", number))
    yield builtin("r2d", math.degrees, Taken("r", number))
    yield builtin("random", source.random)
    yield builtin("norm", _norm, Taken("a", anything))
    yield builtin("normalize", _normalize, Taken("v", vector))
    yield builtin("size", _size, p)
    yield builtin("length", _length, p)
    yield builtin("get_list_length", lambda value: len(value), Taken("v", items))
    count = within(integer, 0, 1000)
    yield builtin("make_list", _make_list, Taken("length", count), Taken("initial_value", anything), Taken("capacity", count, 0))
    yield builtin("integer_to_binary_list", _bits, Taken("x", integer))
    yield builtin("binary_list_to_integer", _from_bits, Taken("l", items))
    yield builtin("inv", _inverse, Taken("m", anything), cost=20)
    yield builtin("transpose", _transposed, Taken("m", items))


OF_TURN = 30
"""What a product of two rotations counts as, beyond a short function's steps of the evaluator."""


def of_poses() -> Iterator[Builtin]:
    """Functions of poses."""
    first, second = Taken("p_from", pose), Taken("p_to", pose)
    yield builtin("pose_trans", algebra.transformed, first, Taken("p_from_to", pose), cost=OF_TURN)
    yield builtin("pose_inv", algebra.inverted, first, cost=OF_TURN)
    yield builtin("pose_add", algebra.added, Taken("p_1", pose), Taken("p_2", pose), cost=OF_TURN)
    yield builtin("pose_sub", algebra.subtracted, second, first, cost=OF_TURN)
    yield builtin("pose_dist", algebra.distance, first, second, cost=OF_TURN)
    yield builtin("point_dist", lambda a, b: math.dist(a[:3], b[:3]), first, second)
    yield builtin("interpolate_pose", algebra.between, first, second, Taken("alpha", number), cost=2 * OF_TURN)
    yield builtin("rpy2rotvec", algebra.from_rpy, Taken("rpy_vector", numbers(3)), cost=2 * OF_TURN)
    yield builtin("rotvec2rpy", algebra.to_rpy, Taken("rotation_vector", numbers(3)), cost=5 * OF_TURN)
    yield builtin("wrench_trans", _wrench, Taken("T_from_to", pose), Taken("w_from", numbers(6)), cost=4 * OF_TURN)


def _no_number(value: Value) -> Value:
    raise Misuse(f"expected a number, this is {kind(value)}")


def _whole(value: int) -> int:
    if abs(value) > GREATEST:
        raise Misuse(f"{value:g} is beyond what an integer holds")
    return value


def _power(a: float, b: float) -> float:
    try:
        found = math.pow(a, b)
    except (ValueError, OverflowError, ZeroDivisionError):
        raise Misuse(f"{a:g} to the power of {b:g} is no number") from None
    return found


def _logarithm(base: float, f: float) -> float:
    if base <= 0.0 or f <= 0.0 or base == 1.0:
        raise Misuse(f"there is no logarithm of {f:g} to the base {base:g}")
    return math.log(f) / math.log(base)


def _norm(a: Value) -> Value:
    if type(a) in NUMBERS:
        return abs(a)
    return math.hypot(*vector(a))


def _normalize(v: tuple[float, ...]) -> tuple[float, ...]:
    size = math.hypot(*v)
    if size == 0.0:
        raise Misuse("all elements are zero")
    return tuple(x / size for x in v)


def _size(value: Value) -> Value:
    if type(value) is tuple and value and type(value[0]) is tuple:
        return (len(value), len(value[0]))
    return _length(value)


def _length(value: Value) -> int:
    if type(value) is str:
        return len(value.encode())
    if type(value) in (tuple, PoseValue):
        return len(value)
    raise Misuse(f"expected a list or a string, this is {kind(value)}")


def _make_list(length: int, initial: Value, capacity: int) -> Value:
    if capacity and capacity < length:
        raise Misuse(f"capacity {capacity} is less than the length {length}")
    return made_list([initial] * length)


def _bits(x: int) -> tuple[bool, ...]:
    return tuple(bool(x >> k & 1) for k in range(32))


def _from_bits(bits: tuple[Value, ...]) -> int:
    if not all(type(bit) is bool for bit in bits):
        raise Misuse("expected a list of bools")
    value = sum(1 << k for k, bit in enumerate(bits[:32]) if bit)
    return value - (1 << 32) if value > GREATEST else value


def _inverse(m: Value) -> Value:
    if type(m) is PoseValue:
        return algebra.inverted(pose(m))
    rows = [list(vector(row)) for row in items(m)] if type(m) is tuple else []
    n = len(rows)
    if not 0 < n <= 20 or any(len(row) != n for row in rows):
        raise Misuse("expected a pose or a square matrix")
    work = [row + [float(i == j) for j in range(n)] for i, row in enumerate(rows)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda k: abs(work[k][i]))
        if abs(work[pivot][i]) < 1e-12:
            raise Misuse("the matrix is singular")
        work[i], work[pivot] = work[pivot], work[i]
        scale = work[i][i]
        work[i] = [x / scale for x in work[i]]
        for k in range(n):
            if k != i:
                factor = work[k][i]
                work[k] = [x - factor * y for x, y in zip(work[k], work[i], strict=True)]
    return tuple(tuple(row[n:]) for row in work)


def _transposed(m: tuple[Value, ...]) -> Value:
    rows = [vector(row) for row in m]
    if not rows or any(len(row) != len(rows[0]) for row in rows):
        raise Misuse("expected a matrix")
    return tuple(zip(*m, strict=True))


def _wrench(frame: PoseValue, wrench: tuple[float, ...]) -> tuple[float, ...]:
    """A wrench at another place and in other axes: forces and torques on the same body."""
    back = algebra.inverted(frame)
    q = algebra.quaternion(back[3:])
    fx, fy, fz = algebra.turned(q, wrench[:3])
    tx, ty, tz = algebra.turned(q, wrench[3:])
    x, y, z = back[:3]
    return (fx, fy, fz, tx + y * fz - z * fy, ty + z * fx - x * fz, tz + x * fy - y * fx)
