"""Another arm on the page: what stands there afterwards, for whom, and what a refusal leaves."""

from collections.abc import Callable, Iterator

import pytest

from app.files.checked import BadInput
from app.kept_setup import Cell
from app.log.live import LiveRecording
from app.session.prepare import prepare
from app.session.session_file import Setup
from app.web.arm_change import BroughtArm, ReadyArm, meshes_of
from app.web.server import Served, serve
from sim.arm.scenario import Scenario
from tests.app.web.fake_loop import ARM, FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


class Arms:
    """Two arms, and one that is refused."""

    names = ("ur10e", "ur5e", "broken")

    def __init__(self, loop: FakeLoop) -> None:
        self._loop = loop

    def ready(self, name: str, held: Cell | None = None) -> ReadyArm:
        if name == "broken":
            raise BadInput("broken.yaml", "robot", name, "an arm that works")
        prepared = prepare(Setup(robot=name), "test")
        return ReadyArm(prepared, None, held, meshes_of(prepared.arm))

    def bring(self, arm: ReadyArm) -> BroughtArm:
        self._loop.scenario = arm.prepared.scenario
        return BroughtArm(None, None, "Network clients were parted.")


@pytest.fixture
def served(loop: FakeLoop, tmp_path: pytest.TempPathFactory) -> Iterator[Served]:
    """The web app, with other arms to choose from."""
    app = serve(loop, ARM, Scenario(), recording=LiveRecording(loop, tmp_path), arms=Arms(loop))  # type: ignore[arg-type]
    yield app
    app.close()


def choose(served: Served, client: RawClient, name: str) -> None:
    setup = served.lab.setup
    client.set(setup.arm._impl.uuid, value=name)
    until(lambda: setup.arm.value == name, "it is chosen")
    client.set(setup.begin._impl.uuid, value=True)


def test_every_page_shows_the_other_arm_and_its_stop_works(served: Served, join: Join, loop: FakeLoop) -> None:
    client, watcher = join(), join()
    old = served.panel
    client.set(served.lab.force._impl.uuid, value=80.0)
    choose(served, client, "ur10e")
    until(lambda: served.panel is not old and served.lab.setup.arm.value == "ur10e", "another page", 20.0)
    until(lambda: "UR10e" in served.lab.setup.message.shown and "parted" in served.lab.setup.message.shown, "it is said")
    assert set(served.control._strips) == {0, 1}
    assert old.stop._impl.removed
    watcher.set(served.panel.stop._impl.uuid, value=True)
    until(lambda: loop.advance() is None and bool(loop.wishes[-1].inputs.commands), "anyone stops it")
    watcher.set(old.stop._impl.uuid, value=True)
    until(lambda: served.guard.refused["unknown control"] == 1, "the stop of the last page is none")
    client.drag("start")
    until(lambda: served.hand.holds(0), "the new arm is taken hold of")


def test_a_dark_page_stays_dark(served: Served, join: Join) -> None:
    client = join()
    until(lambda: 0 in served.preferences._pages, "welcome")
    client.set(served.preferences._pages[0].dark._impl.uuid, value=True)
    until(lambda: served.preferences.dark == {0}, "dark")
    before = served.preferences
    choose(served, client, "ur10e")
    until(lambda: served.preferences is not before and served.preferences.dark == {0}, "still dark", 20.0)


def test_an_arm_that_is_refused_leaves_everything_as_it_was(served: Served, join: Join) -> None:
    client, panel = join(), served.panel
    choose(served, client, "broken")
    until(lambda: "an arm that works" in served.lab.setup.message.shown, "why")
    assert served.panel is panel
    choose(served, client, "ur10e")
    until(lambda: served.panel is not panel, "and another can be chosen", 20.0)


def test_the_arm_that_is_there_begins_again_with_the_set_up(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    client.set(served.lab.setup.begin._impl.uuid, value=True)
    until(lambda: len(loop.begun) == 1, "begun", 20.0)
