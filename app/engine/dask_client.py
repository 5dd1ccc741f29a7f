"""A Dask scheduler to give work to: an embedded one with processes of its own, or one that exists; its workers are checked."""

import atexit
import gc
import importlib.util
import logging
import os
import warnings
from typing import Any

from app.engine.source import identity
from app.files.bad_input import ABSENT, BadInput

CONFIG = {
    "distributed.worker.profile.enabled": False,  # samples every stack a hundred times a second
    "distributed.scheduler.allowed-failures": 5,  # workers that may die under a task
    "distributed.admin.low-level-log-length": 100,  # memory stays as it is, however many runs
    "distributed.admin.log-length": 100,
    "distributed.admin.tick.limit": "30s",  # no warning only because the machine is busy
    "distributed.admin.tick.interval": "500ms",  # the default interrupts the session of a process fifty times a second
    "distributed.admin.system-monitor.interval": "5s",
    "distributed.admin.system-monitor.disk": False,
    "distributed.worker.memory.monitor-interval": "1s",
    "distributed.comm.timeouts.connect": "10s",
    "distributed.deploy.lost-worker-timeout": "60s",  # a process that died starts again, which is slow on a busy machine
}
ANSWER = 10.0
"""How long a scheduler may take to answer [s]."""

PATIENCE = 60.0
"""Time to wait for a scheduler or its first worker [s]."""

_embedded: dict[int, Any] = {}


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0))


def connect(workers: int, scheduler: str | None) -> Any:
    """A Dask client whose workers run the same source as this process.

    Args:
        workers: number of processes of the embedded cluster. The cluster is started once, and kept until this process ends.
        scheduler: address of an existing scheduler, with the workers that it has; None: the embedded cluster.

    Raises:
        BadInput: no scheduler answers at this address, or a worker runs another source.
    """
    from dask import config
    from distributed import Client, LocalCluster

    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    config.set(CONFIG)
    if scheduler is not None:
        client = _remote(scheduler)
        check(client)
        return client
    if workers not in _embedded:
        _embedded[workers] = cluster = LocalCluster(
            n_workers=workers,
            threads_per_worker=1,  # a session holds the interpreter's lock
            processes=True,
            host="127.0.0.1",
            preload=["app.engine.interrupts"],
            dashboard_address="127.0.0.1:0",  # the default listens to the network
            silence_logs=logging.CRITICAL,
        )
        atexit.register(cluster.close)
    return Client(_embedded[workers], set_as_default=False)


def crippled(workers: int) -> bool:
    """Whether a process of the embedded cluster ended for good.

    Dask does not replace a process that was killed during its start, and gives up a process that restarts too late.
    """
    there = _embedded[workers].workers
    return len(there) < workers or any(each.status.name in ("closed", "failed") for each in there.values())


def end_embedded(workers: int) -> None:
    """End an embedded cluster; the next `connect` starts another."""
    cluster = _embedded.pop(workers)
    atexit.unregister(cluster.close)
    cluster.close(timeout=10)


def _remote(scheduler: str) -> Any:
    from distributed import Client

    client, reason = None, ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of packages whose versions differ: `check` names those that matter
            client = Client(scheduler, set_as_default=False, timeout=ANSWER)
    except (OSError, ValueError, ImportError) as error:
        reason = str(error).partition("\n")[0]
    if client is None:
        # The half-made client ends here. If it were collected later, in a thread of Dask, the two threads would wait for each
        # other.
        gc.collect()
        raise BadInput("--scheduler", "", scheduler, f"no Dask scheduler answers there ({reason})")
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        client.close()
        allowed = f"has no worker; start one there with: dask worker {scheduler} --nthreads 1"
        raise BadInput("--scheduler", "", scheduler, allowed) from None
    return client


def check(client: Any) -> None:
    """Compare the workers' source with that of this process. Raises BadInput: a worker runs another source."""
    for address, found in client.run(identity, on_error="return").items():
        if isinstance(found, Exception):
            client.close()
            raise BadInput(
                f"worker {address}", "", ABSENT, f"cannot import this version of pendant ({type(found).__name__}: {found})"
            )
        compare(found, f"worker {address}")


def compare(found: dict[str, str], where: str) -> None:
    """Raise BadInput if `found` differs from the `identity` of this process."""
    for name, value in identity().items():
        if found.get(name) != value:
            raise BadInput(where, name, found.get(name, ABSENT), f"this process has {value}; both must run the same")


def dashboard(client: Any) -> str | None:
    """Address of Dask's own dashboard; None without bokeh, which draws the dashboard."""
    has = client.run_on_scheduler(importlib.util.find_spec, "bokeh") is not None
    return client.dashboard_link if has and client.scheduler_info(n_workers=0)["services"].get("dashboard") else None
