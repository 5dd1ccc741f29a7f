"""A served web app without physics, and clients for it."""

from collections.abc import Callable, Iterator

import pytest

from app.web.server import Served, serve
from sim.arm.scenario import Scenario
from tests.app.web.fake_loop import ARM, FakeLoop
from tests.app.web.raw_client import RawClient, until


@pytest.fixture
def loop() -> FakeLoop:
    """The loop that is served."""
    return FakeLoop()


@pytest.fixture
def served(loop: FakeLoop) -> Iterator[Served]:
    """The web app of `loop`."""
    app = serve(loop, ARM, Scenario())
    yield app
    app.close()


@pytest.fixture
def still(served: Served) -> Served:
    """It, but only the test brings its page up to date."""
    served.stop_drawing()
    return served


@pytest.fixture
def join(served: Served) -> Iterator[Callable[[], RawClient]]:
    """Connects one client after the other; client n has the number n."""
    clients: list[RawClient] = []

    def connect() -> RawClient:
        client = RawClient(served.url)
        clients.append(client)
        until(lambda: len(served.server.get_clients()) == len(clients), "the client is connected")
        return client

    yield connect
    for client in clients:
        client.close()
