"""Pictures of the arm in its world by MuJoCo, without a screen: for the environment, and for videos of recordings."""

import math
import os
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import mujoco
import numpy as np
import trimesh
from numpy.typing import NDArray

from app.files.bad_input import ABSENT, BadInput
from app.files.library import mesh_path
from sim.arm.arm_file import Arm
from sim.arm.frames import joint_frames, rotation_from_rpy
from sim.arm.scenario import AnyObject, FreeCylinder, Pad, Plane, Scenario, SnapFit, TwoFrictions
from sim.exchange.snapshot import Snapshot

Array = NDArray[np.float64]
Colour = tuple[float, float, float, float]

METRES_PER_NEWTON = 0.008
LONGEST_ARROW = 0.4  # [m]
ARROW_WIDTH = 0.012  # [m]

DARK: Colour = (0.15, 0.16, 0.19, 1.0)
ORANGE: Colour = (0.90, 0.59, 0.24, 1.0)
BLUE: Colour = (0.10, 0.44, 0.76, 1.0)
GREEN: Colour = (0.18, 0.65, 0.33, 0.6)
GREY: Colour = (0.68, 0.71, 0.74, 1.0)
WORLD: dict[type, Colour] = {
    Pad: (0.59, 0.75, 0.63, 1.0),
    SnapFit: (0.75, 0.67, 0.55, 1.0),
    TwoFrictions: (0.67, 0.67, 0.78, 1.0),
}

MORE_SHAPES = 20
"""Largest number of arrows and markers in a picture."""

UNSEEN = (0.0, 0.0, -10.0)
"""Place of the payload's shape when there is no payload: out of view [m]."""


class Marker(NamedTuple):
    """A ball that only pictures have."""

    point: Array  # (3,) in W [m]
    radius: float  # [m]


class ArmCamera:
    """Draws snapshots of a simulation or of a recording. Nothing is simulated: bodies are put at the places of the snapshot.

    Without MUJOCO_GL in the environment it draws by EGL, which needs neither a screen nor a graphics card.

    Args:
        arm, scenario: the arm, and the world that is drawn with it.
        height, width: of a picture [pixels].

    Raises:
        BadInput: OpenGL is missing; the message says what to install.
    """

    def __init__(self, arm: Arm, scenario: Scenario, height: int, width: int) -> None:
        self._names = ["foot", *arm.chain.joints, "flange"]
        self._objects = [f"object/{thing.name}" for thing in scenario.world if not _is_floor(thing)]
        self._rows = [row for row, thing in enumerate(scenario.world) if not _is_floor(thing)]
        self._model = _model(arm, scenario, height, width)
        self._data = mujoco.MjData(self._model)
        model = self._model
        self._mocap = {name: int(model.body(name).mocapid[0]) for name in [*self._names, "payload", *self._objects]}
        self._ball = model.geom("payload").id
        self._context: Any = _context(height, width)
        self._context.make_current()
        self._drawing = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._drawing)
        self._scene = mujoco.MjvScene(model, maxgeom=model.ngeom + MORE_SHAPES)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        self._option, self._view = mujoco.MjvOption(), _view(arm, scenario)
        self._size = mujoco.MjrRect(0, 0, width, height)
        self._pixels = np.empty((height, width, 3), dtype=np.uint8)

    def picture(self, snapshot: Snapshot, markers: Sequence[Marker] = (), *, arrows: bool = False) -> NDArray[np.uint8]:
        """The picture of a snapshot, (height, width, 3).

        Args:
            snapshot: the arm, its payload and the world.
            markers: balls that are drawn as well; a real camera would not see them.
            arrows: the forces of hands are drawn, too.
        """
        self._place(snapshot)
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        self._context.make_current()
        every = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(self._model, self._data, self._option, None, self._view, every, self._scene)
        for marker in markers:
            self._add_ball(marker)
        for _, point, force, _ in snapshot.touches if arrows else ():
            self._add_arrow(np.array(point), np.array(force))
        mujoco.mjr_render(self._size, self._scene, self._drawing)
        mujoco.mjr_readPixels(self._pixels, None, self._size, self._drawing)
        return self._pixels[::-1].copy()  # OpenGL begins at the bottom

    def close(self) -> None:
        """Free the drawing context."""
        if self._context is not None:
            self._context.make_current()
            self._drawing.free()
            self._context.free()
            self._context = None

    def _place(self, snapshot: Snapshot) -> None:
        poses = dict(zip(self._names, snapshot.truth_links, strict=True))
        poses |= {name: snapshot.truth_objects[row] for name, row in zip(self._objects, self._rows, strict=True)}
        payload = snapshot.truth_payload
        poses["payload"] = np.array([*UNSEEN, 1.0, 0.0, 0.0, 0.0]) if payload is None else payload
        if snapshot.truth_payload_mass > 0.0:  # a ball of water, as on the page
            self._model.geom_size[self._ball, 0] = (3.0 * snapshot.truth_payload_mass / (4.0 * math.pi * 1000.0)) ** (1.0 / 3.0)
        for name, pose in poses.items():
            self._data.mocap_pos[self._mocap[name]], self._data.mocap_quat[self._mocap[name]] = pose[:3], pose[3:]

    def _add_ball(self, marker: Marker) -> None:
        geom = self._next()
        size = np.full(3, marker.radius)
        mujoco.mjv_initGeom(
            geom, mujoco.mjtGeom.mjGEOM_SPHERE, size, marker.point, np.eye(3).ravel(), np.array(GREEN, dtype="f4")
        )

    def _add_arrow(self, point: Array, force: Array) -> None:
        """Add an arrow from the touched point along the force."""
        size = float(np.linalg.norm(force))
        if size < 0.5:  # too small to have a direction that can be seen
            return
        tip = point + force / size * min(size * METRES_PER_NEWTON, LONGEST_ARROW)
        geom = self._next()
        arrow = mujoco.mjtGeom.mjGEOM_ARROW
        mujoco.mjv_initGeom(geom, arrow, np.zeros(3), np.zeros(3), np.eye(3).ravel(), np.array(BLUE, dtype="f4"))
        mujoco.mjv_connector(geom, arrow, ARROW_WIDTH, point, tip)

    def _next(self) -> mujoco.MjvGeom:
        geom = self._scene.geoms[self._scene.ngeom]
        self._scene.ngeom += 1
        return geom


def _is_floor(thing: AnyObject) -> bool:
    """A level plane is drawn as the floor."""
    return isinstance(thing, Plane) and not any(thing.rpy)


def _context(height: int, width: int) -> Any:
    """An OpenGL context of MuJoCo's: the one that MUJOCO_GL names, or EGL."""
    try:
        if "MUJOCO_GL" in os.environ:
            return mujoco.GLContext(width, height)
        from mujoco.egl import GLContext

        return GLContext(width, height)
    except (ImportError, AttributeError, RuntimeError, mujoco.FatalError) as error:
        allowed = f"pictures need EGL or OSMesa, such as Debian's libegl1 with libgl1-mesa-dri ({' '.join(str(error).split())})"
        raise BadInput("camera", "MUJOCO_GL", os.environ.get("MUJOCO_GL", ABSENT), allowed) from None


def _model(arm: Arm, scenario: Scenario, height: int, width: int) -> mujoco.MjModel:
    """A model only of bodies with a place and a visible shape."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.visual.global_.offheight, spec.visual.global_.offwidth = height, width
    spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.35] * 3, [0.35] * 3
    spec.visual.headlight.specular = [0.1] * 3
    spec.visual.quality.shadowsize = 1024
    spec.visual.quality.offsamples = 0  # smoothing of edges takes longer than all the rest, where there is no graphics card
    level = min([0.0, *(thing.position[2] for thing in scenario.world if _is_floor(thing))])
    sky = spec.add_texture(name="sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT)
    sky.rgb1, sky.rgb2, sky.width, sky.height = [0.93, 0.95, 0.97], [0.80, 0.84, 0.88], 128, 768
    _add_floor(spec, level)
    spec.worldbody.add_light(pos=[1.5, -1.5, 3.0], dir=[-0.4, 0.4, -0.8], diffuse=[0.6] * 3, specular=[0.2] * 3)
    for name in ("foot", *arm.chain.joints):
        body = spec.worldbody.add_body(name=name, mocap=True)
        for k, (vertices, faces, colour) in enumerate(_surfaces(arm, name)):
            spec.add_mesh(name=f"{name}/{k}", uservert=vertices.ravel(), userface=faces.ravel())
            body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=f"{name}/{k}", rgba=colour)
    flange = spec.worldbody.add_body(name="flange", mocap=True)
    tool = scenario.tool
    if tool is not None and tool.length > 0.0:
        middle = [0.0, 0.0, tool.length / 2.0]
        flange.add_geom(type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[tool.radius, tool.length / 2.0, 0.0], pos=middle, rgba=DARK)
    payload = spec.worldbody.add_body(name="payload", mocap=True)
    payload.add_geom(name="payload", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.01, 0.0, 0.0], rgba=ORANGE)
    for thing in scenario.world:
        if not _is_floor(thing):
            body = spec.worldbody.add_body(name=f"object/{thing.name}", mocap=True)
            kind, size = mujoco.mjtGeom.mjGEOM_BOX, [1.5, 1.5, 0.001]
            if isinstance(thing, FreeCylinder):
                kind, size = mujoco.mjtGeom.mjGEOM_CYLINDER, [thing.radius, thing.height / 2.0, 0.0]
            elif not isinstance(thing, Plane):
                size = [side / 2.0 for side in thing.size]
            body.add_geom(type=kind, size=size, rgba=WORLD.get(type(thing), GREY))
    return spec.compile()


def _add_floor(spec: mujoco.MjSpec, level: float) -> None:
    tiles = spec.add_texture(name="tiles", type=mujoco.mjtTexture.mjTEXTURE_2D, builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER)
    tiles.rgb1, tiles.rgb2, tiles.width, tiles.height = [0.86, 0.88, 0.90], [0.80, 0.82, 0.85], 300, 300
    floor = spec.add_material(name="floor", texrepeat=[4.0, 4.0], texuniform=True)
    floor.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "tiles"
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE, size=[4.0, 4.0, 0.1], pos=[0.0, 0.0, level - 0.001], material="floor"
    )


def _surfaces(arm: Arm, part: str) -> Iterator[tuple[Array, NDArray[np.int32], list[float]]]:
    """Vertices (v, 3) [m], faces (f, 3) and colour of each surface of a part; nothing for a part without a mesh."""
    try:
        drawn = trimesh.load_scene(mesh_path(arm, part))
    except BadInput:
        return
    for node in drawn.graph.nodes_geometry:
        pose, name = drawn.graph[node]
        surface = drawn.geometry[name]
        assert isinstance(surface, trimesh.Trimesh)
        vertices = trimesh.transform_points(surface.vertices, pose)
        colour = np.asarray(surface.visual.material.baseColorFactor, dtype=float) / 255.0  # type: ignore[union-attr]
        yield vertices, np.asarray(surface.faces, dtype=np.int32), colour.tolist()


def _view(arm: Arm, scenario: Scenario) -> mujoco.MjvCamera:
    """The view from the front of the arm's first posture, a little from above, with the arm's reach in view."""
    posture = scenario.posture if scenario.posture is not None else arm.chain.home
    R_WB = rotation_from_rpy(scenario.mounting)
    points = joint_frames(arm, posture)[:, :3, 3] @ R_WB.T
    centre = (points.min(axis=0) + points.max(axis=0)) / 2.0
    side = points[-1, :2] - points[0, :2]
    view = mujoco.MjvCamera()
    view.type = mujoco.mjtCamera.mjCAMERA_FREE
    view.lookat = centre
    view.distance = 1.9 * arm.reach
    view.azimuth = math.degrees(math.atan2(side[1], side[0])) - 60.0
    view.elevation = -22.0
    return view
