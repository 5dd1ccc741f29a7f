"""The picture: arm, tool, payload, world and touches, drawn from snapshots."""

import math
from collections.abc import Callable, Mapping

import numpy as np
import trimesh
import viser
from numpy.typing import NDArray
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from app.web.scene.arm_marks import ball_radius
from app.web.scene.force_ellipsoid import ForceEllipsoid
from app.web.scene.stage import DARK, LIGHT, Shadow, Top, lay, top_of
from app.web.scene.touch_arrow import TouchArrow
from app.web.scene.wall_pictures import WallPictures
from sim.arm.arm_file import Arm
from sim.arm.frames import matrix_from_quaternion, quaternion_from_matrix
from sim.arm.scenario import Fingers, FreeBox, FreeCylinder, Pad, Plane, Scenario, SnapFit, TwoFrictions
from sim.exchange.snapshot import Snapshot
from sim.gripping.finger_shape import finger_poses, finger_size, palm_length

Array = NDArray[np.float64]

STEP = 2e-5
"""Changes smaller than this are not sent [m, and 1 for quaternions]."""

TOOL = "/arm/tool"
"""Name of the tool's node."""

BELIEVED_APART = 0.05
"""A configured payload that differs from the true one by less is not shown beside it [kg]."""

SHADED = 3
"""Objects that the arm's shadow is shown on."""

TOUCHES = 4
"""Touches shown at once."""

GREY = (173, 181, 189)
PART = (222, 150, 70)
WORLD_COLOURS = {
    Pad: (150, 190, 160),
    SnapFit: (190, 170, 140),
    TwoFrictions: (170, 170, 200),
    FreeBox: PART,
    FreeCylinder: PART,
}


def frames_of(arm: Arm) -> dict[str, int]:
    """For each part of the arm, the row of `Snapshot.truth_links` with its frame."""
    rows = {name: row for row, name in enumerate(("foot", *arm.chain.joints))}
    return rows | {"flange": arm.n + 1, "tool": arm.n + 1}


class Scene:
    """What viser shows. `meshes` has a GLB file for each part that has a shape."""

    def __init__(
        self, server: viser.ViserServer, arm: Arm, scenario: Scenario, *, meshes: Mapping[str, bytes], first: Snapshot
    ) -> None:
        self._server = server
        self._scenario = scenario
        self.on_tool: Callable[[viser.GlbHandle], None] = lambda tool: None  # told of a tool that another scenario brings
        self._frames = frames_of(arm)
        self._last: dict[str, Array] = {}
        self._nodes: dict[str, viser.SceneNodeHandle] = {}
        self.draggable: dict[str, viser.GlbHandle] = {}
        self._stage()
        self._frame(first.truth_links[:, :3], arm.reach)
        for part, row in self._frames.items():
            if part in meshes:
                self.draggable[part] = server.scene.add_glb(f"/arm/{part}", meshes[part], cast_shadow=False, receive_shadow=False)
                self._nodes[f"link {row} {part}"] = self.draggable[part]
        self._fingers: list[viser.SceneNodeHandle] = []
        self._add_tool(scenario)
        self._add_world(scenario)
        self._payload = server.scene.add_icosphere("/payload", radius=1.0, color=(230, 150, 60), visible=False, cast_shadow=False)
        self._believed = server.scene.add_icosphere(
            "/believed", radius=1.0, color=(25, 113, 194), opacity=0.35, visible=False, cast_shadow=False
        )
        self._believed_label = server.scene.add_label("/believed label", "", visible=False, anchor="top-center")
        self.arrows = [TouchArrow(server.scene, i) for i in range(TOUCHES)]
        self.user = ForceEllipsoid(server.scene)
        self.walls = WallPictures(server)
        self.shadow = Shadow(server.scene)

    @property
    def texts(self) -> list[viser.LabelHandle]:
        """What is written in it, by precedence, in W."""
        return [*(arrow.label for arrow in self.arrows), *self.walls.texts, self._believed_label]

    def show(self, snapshot: Snapshot) -> bool:
        """Draw a snapshot, in one batch that clients apply together; True if anything changed."""
        changed = False
        with self._server.atomic():
            if snapshot.scenario is not None and snapshot.scenario is not self._scenario:
                self._change_to(snapshot.scenario)
            for key, node in self._nodes.items():
                kind, row, _ = key.split(" ", 2)
                poses = snapshot.truth_links if kind == "link" else snapshot.truth_objects
                changed |= self._place(key, node, poses[int(row)])
            changed |= self.shadow.show(snapshot.truth_links[:, :3], float(self._floor.position[2]), self._tops(snapshot))
            changed |= self._show_fingers(snapshot)
            changed |= self._show_payload(snapshot)
            changed |= self._show_believed(snapshot)
            changed |= self._show_touches(snapshot)
            changed |= self.user.show(snapshot)
            changed |= self.walls.show(snapshot)
        if changed:
            self._server.flush()
        return changed

    def _tops(self, snapshot: Snapshot) -> list[Top]:
        """What the shadow can fall on beside the floor."""
        found = [top_of(size, snapshot.truth_objects[row]) for row, size in self._boxes.items()]
        return [top for top in found if top is not None][:SHADED]

    def _change_to(self, scenario: Scenario) -> None:
        """Put away the tool and the world of the last scenario, and show those of `scenario`."""
        self._scenario = scenario
        for key in [key for key in self._nodes if key.startswith("object ") or key.endswith(" tool")]:
            self._nodes.pop(key).remove()
        self._last.clear()
        while self._fingers:
            self._fingers.pop().remove()
        self.draggable.pop("tool", None)
        self._add_tool(scenario)
        self._add_world(scenario)
        if "tool" in self.draggable:
            self.on_tool(self.draggable["tool"])

    def _place(self, key: str, node: viser.SceneNodeHandle, pose: Array) -> bool:
        last = self._last.get(key)
        if last is not None and float(np.max(np.abs(last - pose))) < STEP:
            return False
        if last is None or float(np.max(np.abs(last[:3] - pose[:3]))) >= STEP:
            node.position = np.round(pose[:3], 5)
        if last is None or float(np.max(np.abs(last[3:] - pose[3:]))) >= STEP:
            node.wxyz = np.round(pose[3:], 5)
        self._last[key] = pose.copy()
        return True

    def _show_payload(self, snapshot: Snapshot) -> bool:
        pose = snapshot.truth_payload
        visible = pose is not None
        changed = self._payload.visible != visible
        if changed:
            self._payload.visible = visible
        if pose is None:
            return changed
        radius = ball_radius(snapshot.truth_payload_mass)
        if snapshot.truth_payload_mass > 0.0 and self._payload.scale != radius:
            self._payload.scale = radius
            changed = True
        return self._place("payload", self._payload, pose) or changed

    def _show_believed(self, snapshot: Snapshot) -> bool:
        """Beside the true payload that which the controller believes in, where they differ."""
        fitting, mass = snapshot.decision.estimator.fitting, snapshot.configured_mass
        differs = abs(mass - snapshot.truth_payload_mass) >= BELIEVED_APART
        visible = fitting is not None and differs
        changed = self._believed.visible != visible
        if changed:
            self._believed.visible = self._believed_label.visible = visible
        if fitting is None or not visible:
            return changed
        face = snapshot.truth_links[-1]
        place = face[:3] + matrix_from_quaternion(face[3:]) @ np.array(fitting.load.com if mass > 0.0 else (0.0, 0.0, 0.05))
        if self._believed.scale != (radius := ball_radius(mass)):
            self._believed.scale, changed = radius, True
        if self._believed_label.text != (text := f"Configured: {mass:.1f} kg"):
            self._believed_label.text, changed = text, True
        moved = self._place("believed", self._believed, np.concatenate([place, face[3:]]))
        if moved:
            self._believed_label.position = np.round(place, 3)
        return moved or changed

    def _show_touches(self, snapshot: Snapshot) -> bool:
        touches = [touch[1:] for touch in snapshot.touches[:TOUCHES]]
        changed = [arrow.show(touches[i] if i < len(touches) else None) for i, arrow in enumerate(self.arrows)]
        return any(changed)

    def _add_tool(self, scenario: Scenario) -> None:
        tool = scenario.tool
        if tool is None or tool.length <= 0.0:
            return
        length = palm_length(tool)
        if length > 2.0 * tool.radius:  # as it is in the simulation
            shape = trimesh.creation.capsule(length - 2.0 * tool.radius, tool.radius, count=[24, 16])
        else:
            shape = trimesh.creation.cylinder(tool.radius, length, sections=32)
        shape.apply_translation([0.0, 0.0, length / 2])
        shape.visual = TextureVisuals(
            material=PBRMaterial(baseColorFactor=[38, 42, 48, 255], metallicFactor=0.0, roughnessFactor=0.5)
        )
        handle = self._server.scene.add_mesh_trimesh(TOOL, shape, cast_shadow=False, receive_shadow=False)
        self.draggable["tool"] = handle
        self._nodes[f"link {self._frames['tool']} tool"] = handle
        if isinstance(tool.gripper, Fingers):
            size = finger_size(tool.gripper)
            self._fingers = [
                self._server.scene.add_box(
                    f"/arm/finger {k}", dimensions=size, color=(70, 76, 84), cast_shadow=False, receive_shadow=False
                )
                for k in range(2)
            ]

    def _show_fingers(self, snapshot: Snapshot) -> bool:
        """The fingers where the gripper has them; open, where that is not known."""
        tool = self._scenario.tool
        if not self._fingers or tool is None or not isinstance(tool.gripper, Fingers):
            return False
        state, face = snapshot.gripper, snapshot.truth_links[-1]
        opening = tool.gripper.stroke if state is None else state.opening
        R, changed = matrix_from_quaternion(face[3:]), False
        for k, own in enumerate(finger_poses(tool, tool.gripper, opening)):
            turn = quaternion_from_matrix(R @ matrix_from_quaternion(own[3:]))
            changed |= self._place(f"finger {k}", self._fingers[k], np.concatenate([face[:3] + R @ own[:3], turn]))
        return changed

    def _add_world(self, scenario: Scenario) -> None:
        level = min([0.0, *(thing.position[2] for thing in scenario.world if isinstance(thing, Plane) and not any(thing.rpy))])
        self._floor.position = (0.0, 0.0, level)  # so that it hides nothing that stands on a lower floor
        self._boxes: dict[int, Array] = {}  # sizes of those that a shadow falls on, by their row
        for row, thing in enumerate(scenario.world):
            if isinstance(thing, Plane) and thing.position[2] == level and not any(thing.rpy):
                continue  # it is the floor
            size = np.array([3.0, 3.0, 0.002] if isinstance(thing, Plane) else thing.size)
            colour = WORLD_COLOURS.get(type(thing), GREY)
            if isinstance(thing, FreeCylinder):
                shape = trimesh.creation.cylinder(thing.radius, thing.height, sections=32)
                self._nodes[f"object {row} {thing.name}"] = self._server.scene.add_mesh_simple(
                    f"/world/{row}", shape.vertices, shape.faces, color=colour, cast_shadow=False, receive_shadow=False
                )
                continue
            self._boxes[row] = size
            self._nodes[f"object {row} {thing.name}"] = self._server.scene.add_box(
                f"/world/{row}",
                dimensions=size,
                color=colour,
                opacity=0.35 if isinstance(thing, Plane) else None,
                cast_shadow=False,
                receive_shadow=False,
            )

    def _stage(self) -> None:
        """Lamps, floor and background."""
        scene = self._server.scene
        scene.set_up_direction("+z")
        # Light from lamps alone: an environment map makes a frame 25 times as long where there is no graphics card.
        scene.configure_environment_map(None)
        scene.configure_default_lights(False)
        scene.add_light_hemisphere("/light/sky", sky_color=(255, 255, 255), ground_color=(176, 182, 190), intensity=2.6)
        self._floor = lay(scene, LIGHT)

    def set_theme(self, scene: viser.SceneApi, dark: bool) -> None:
        """Floor and background of one client's page."""
        lay(scene, DARK if dark else LIGHT).position = self._floor.position

    def _frame(self, points: Array, reach: float) -> None:
        """Look at the arm and light it from its front, a little from above, so that its whole reach is in view."""
        centre = (points.min(axis=0) + points.max(axis=0)) / 2
        side = points[-1] - points[0]
        side[2] = 0.0
        side = side / max(float(np.linalg.norm(side)), 1e-6)
        across = np.array([-side[1], side[0], 0.0])
        lamps = self._server.scene
        lamps.add_light_directional(
            "/light/key", intensity=2.2, position=centre + 2.0 * across - 0.6 * side + np.array([0.0, 0.0, 2.5])
        )
        lamps.add_light_directional(
            "/light/fill", intensity=0.7, position=centre + 2.5 * side - 0.5 * across + np.array([0.0, 0.0, 0.6])
        )
        camera = self._server.initial_camera
        camera.look_at = tuple(centre)
        camera.position = tuple(centre + reach * (0.9 * side + 1.9 * across + np.array([0.0, 0.0, 0.75])))
        camera.fov = math.radians(40.0)
