import numpy as np
import pytest

from app.api import session, step, stepped
from app.files.bad_input import BadInput
from app.learning import camera
from app.learning.camera import ArmCamera, Marker
from sim.arm.scenario import BoxObject, Scenario, ToolModel
from sim.plant.touch import Push
from sim.simulation import Simulation


@pytest.fixture(scope="module")
def simulation() -> Simulation:
    made = stepped(session({"title": "pictures", "duration": 1.0, "payload_true": {"mass": 2.0}}))
    step(made, 2, touches=[Push("flange", (0.0, 0.0, 0.0), (0.0, 30.0, 0.0))])
    return made


def changed(one: np.ndarray, other: np.ndarray) -> int:
    """Pixels that differ."""
    return int((np.abs(one.astype(int) - other).max(axis=2) > 10).sum())


def test_a_picture_shows_what_there_is(simulation: Simulation) -> None:
    shot = ArmCamera(simulation.arm, simulation.scenario, 120, 160)
    snapshot = simulation.snapshot()
    plain = shot.picture(snapshot)
    assert plain.shape == (120, 160, 3)
    assert plain.dtype == np.uint8
    assert int((plain.max(axis=2) < 90).sum()) > 50  # dark parts of the arm before a light floor
    np.testing.assert_array_equal(plain, shot.picture(snapshot))
    near = Marker(snapshot.truth_links[-1, :3] + [0.0, 0.0, 0.2], 0.05)
    assert changed(shot.picture(snapshot, [near]), plain) > 20
    assert changed(shot.picture(snapshot, arrows=True), plain) > 3
    shot.close()
    shot.close()  # twice is no error


def test_tool_and_world_are_in_the_picture(simulation: Simulation) -> None:
    block = BoxObject(name="block", position=[-0.4, -0.4, 0.1], size=[0.2, 0.2, 0.2])
    tool = ToolModel(name="rod", mass=0.1, com=[0.0, 0.0, 0.05], tcp=[0.0, 0.0, 0.1], length=0.1)
    pictures = []
    for scenario in (Scenario(), Scenario(world=[block]), Scenario(tool=tool)):
        shown = Simulation(simulation.arm, scenario, simulation.settings)
        step(shown, 1)
        shot = ArmCamera(simulation.arm, scenario, 120, 160)
        pictures.append(shot.picture(shown.snapshot()))
        shot.close()
    assert changed(pictures[1], pictures[0]) > 100
    assert changed(pictures[2], pictures[0]) > 10


def test_a_computer_that_cannot_draw_is_told_what_is_missing(simulation: Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(width: int, height: int) -> None:
        raise RuntimeError("no display")

    monkeypatch.setenv("MUJOCO_GL", "glfw")
    monkeypatch.setattr(camera.mujoco, "GLContext", broken)
    with pytest.raises(BadInput, match=r"MUJOCO_GL = glfw: pictures need EGL or OSMesa.*no display"):
        ArmCamera(simulation.arm, simulation.scenario, 120, 160)
