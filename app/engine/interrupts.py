"""Loaded by each worker of the embedded cluster. Only the process that gave the work reacts to Ctrl-C; it ends its workers."""

import signal


def dask_setup(worker: object) -> None:  # noqa: ARG001 Dask gives it
    """Ignore the terminal's interrupt, because a traceback of each worker would hide the one line that matters."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
