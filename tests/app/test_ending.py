"""The end by a signal, in processes of their own: in order where that goes, and in time whatever hangs."""

import signal
import subprocess
import sys
import time

import pytest

from app.ending import ORDERLY, STUCK

SLACK = 5.0
"""Of a machine that is busy [s]: far below what would hang."""

ORDER = """
from app.ending import ending
with ending() as end:
    print("ready", flush=True)
    end.asked.wait()
    print("in order", flush=True)
"""
HANGS = """
import time
from app.ending import ending
with ending() as end:
    end.see_to(lambda left: print("finished", left > 0.0, flush=True))
    print("ready", flush=True)
    while True:
        time.sleep(60.0)
"""
STANDS = """
import ctypes, time
from app.ending import ending
with ending() as end:
    end.see_to(lambda left: ctypes.PyDLL(None).sleep(60))  # nobody can run any Python meanwhile
    print("ready", flush=True)
    time.sleep(60.0)
"""
INTERRUPTED = """
import time
from app.ending import ending, signal_that_came
try:
    with ending(interrupts=True):
        print("ready", flush=True)
        time.sleep(60.0)
except KeyboardInterrupt:
    print("interrupted", signal_that_came(), flush=True)
    time.sleep(4.0)
    print("goes on", flush=True)
"""


def ended(code: str, number: int) -> tuple[int, str, float]:
    """Exit code of a program that gets a signal when it is ready, what it said from there on, and the time to its end [s]."""
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        process.send_signal(number)
        begun = time.monotonic()
        said = process.stdout.read()
        return process.wait(60.0), said, time.monotonic() - begun


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_who_looks_ends_in_order(number: int) -> None:
    code, said, _ = ended(ORDER, number)
    assert (code, said) == (0, "in order\n")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_what_hangs_is_ended_with_what_must_be_done_done(number: int) -> None:
    code, said, took = ended(HANGS, number)
    assert (code, said) == (128 + number, "finished True\n")
    assert took < ORDERLY + SLACK


def test_where_no_python_runs_the_system_ends_it() -> None:
    code, _, took = ended(STANDS, signal.SIGTERM)
    assert code == -signal.SIGALRM
    assert took < STUCK + SLACK


def test_who_takes_the_interrupt_goes_on() -> None:
    code, said, _ = ended(INTERRUPTED, signal.SIGINT)
    assert (code, said) == (0, f"interrupted {signal.SIGINT.value}\ngoes on\n")
