"""Loaded by each worker of the embedded cluster: Ctrl-C is for the process that gave the work, which ends its workers."""

import signal


def dask_setup(worker: object) -> None:  # noqa: ARG001 Dask gives it
    """Ignore the terminal's interrupt; a traceback of each worker would hide the one line that matters."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
