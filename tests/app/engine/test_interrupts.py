import signal

from app.engine.interrupts import dask_setup


def test_a_worker_ignores_the_terminals_interrupt() -> None:
    before = signal.getsignal(signal.SIGINT)
    try:
        dask_setup(None)
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)
