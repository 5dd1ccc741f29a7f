"""Messages and schemas that Foxglove draws by itself: transforms, the scene, log lines. JSON, told apart by the schema's name."""

import base64
import math
from collections.abc import Iterable, Sequence
from typing import Any

from pendant.events.event_row import Severity
from pendant.tick.modes import TICK_RATE

Json = dict[str, Any]
NANOSECONDS = 1_000_000_000 // TICK_RATE
"""Length of a tick."""

NUMBER: Json = {"type": "number"}
TEXT: Json = {"type": "string"}
COUNT: Json = {"type": "integer", "minimum": 0}
SWITCH: Json = {"type": "boolean"}


def record(**fields: Json) -> Json:
    """Schema of an object."""
    return {"type": "object", "properties": fields}


def several(items: Json) -> Json:
    """Schema of an array."""
    return {"type": "array", "items": items}


TIME = record(sec=COUNT, nsec={**COUNT, "maximum": 999_999_999})
VECTOR = record(x=NUMBER, y=NUMBER, z=NUMBER)
QUATERNION = record(x=NUMBER, y=NUMBER, z=NUMBER, w=NUMBER)
COLOUR = record(r=NUMBER, g=NUMBER, b=NUMBER, a=NUMBER)
POSE = record(position=VECTOR, orientation=QUATERNION)
_ARROW = record(pose=POSE, shaft_length=NUMBER, shaft_diameter=NUMBER, head_length=NUMBER, head_diameter=NUMBER, color=COLOUR)
_SHAPE = record(pose=POSE, size=VECTOR, color=COLOUR)
_CYLINDER = record(pose=POSE, size=VECTOR, bottom_scale=NUMBER, top_scale=NUMBER, color=COLOUR)
_MODEL = record(
    pose=POSE,
    scale=VECTOR,
    color=COLOUR,
    override_color=SWITCH,
    url=TEXT,
    media_type=TEXT,
    data={**TEXT, "contentEncoding": "base64"},
)
_ENTITY = record(
    timestamp=TIME,
    frame_id=TEXT,
    id=TEXT,
    lifetime=TIME,
    frame_locked=SWITCH,
    metadata=several(record(key=TEXT, value=TEXT)),
    arrows=several(_ARROW),
    cubes=several(_SHAPE),
    spheres=several(_SHAPE),
    cylinders=several(_CYLINDER),
    models=several(_MODEL),
)
_TRANSFORM = record(timestamp=TIME, parent_frame_id=TEXT, child_frame_id=TEXT, translation=VECTOR, rotation=QUATERNION)

SCHEMAS: dict[str, Json] = {
    "foxglove.FrameTransforms": {"title": "foxglove.FrameTransforms", **record(transforms=several(_TRANSFORM))},
    "foxglove.SceneUpdate": {
        "title": "foxglove.SceneUpdate",
        **record(deletions=several(record(timestamp=TIME, type=COUNT, id=TEXT)), entities=several(_ENTITY)),
    },
    "foxglove.Log": {
        "title": "foxglove.Log",
        **record(timestamp=TIME, level=COUNT, message=TEXT, name=TEXT, file=TEXT, line=COUNT),
    },
}
"""JSON schemas by the name that Foxglove knows."""

LEVELS = {Severity.INFO: 2, Severity.NOTICE: 2, Severity.WARNING: 3, Severity.STOP: 4}
HAND_COLOUR = {"r": 0.1, "g": 0.44, "b": 0.76, "a": 1.0}
LOAD_COLOUR = {"r": 0.9, "g": 0.59, "b": 0.24, "a": 1.0}
WORLD_COLOUR = {"r": 0.68, "g": 0.71, "b": 0.74, "a": 1.0}
UNIT = {"x": 1.0, "y": 1.0, "z": 1.0}
NOWHERE: Json = {"position": {"x": 0.0, "y": 0.0, "z": 0.0}, "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}
METRES_PER_NEWTON = 0.004


def moment(tick: int) -> Json:
    """A tick as Foxglove's time; it counts from the start of the run."""
    second, rest = divmod(tick, TICK_RATE)
    return {"sec": second, "nsec": rest * NANOSECONDS}


def transforms(tick: int, frames: Iterable[tuple[str, Sequence[float]]]) -> Json:
    """FrameTransforms of frames in `world`: each a name and a pose, position [m] then quaternion wxyz."""
    time = moment(tick)
    return {
        "transforms": [
            {
                "timestamp": time,
                "parent_frame_id": "world",
                "child_frame_id": name,
                "translation": {"x": x, "y": y, "z": z},
                "rotation": {"x": i, "y": j, "z": k, "w": w},
            }
            for name, (x, y, z, w, i, j, k) in frames
        ]
    }


def entity(tick: int, ident: str, frame: str, **content: Any) -> Json:
    """A SceneEntity that stays until the next of its name."""
    lists: Json = {"metadata": [], "arrows": [], "cubes": [], "spheres": [], "cylinders": [], "models": []}
    head = {"timestamp": moment(tick), "frame_id": frame, "id": ident, "lifetime": {"sec": 0, "nsec": 0}, "frame_locked": True}
    return {**head, **lists, **content}


def update(entities: list[Json]) -> Json:
    """A SceneUpdate."""
    return {"deletions": [], "entities": entities}


def model(data: bytes) -> Json:
    """A GLB file as a ModelPrimitive."""
    return {
        "pose": NOWHERE,
        "scale": UNIT,
        "color": WORLD_COLOUR,
        "override_color": False,
        "url": "",
        "media_type": "model/gltf-binary",
        "data": base64.b64encode(data).decode(),
    }


def box(size: Sequence[float]) -> Json:
    """A CubePrimitive with full lengths [m]."""
    return {"pose": NOWHERE, "size": dict(zip("xyz", size, strict=True)), "color": WORLD_COLOUR}


def cylinder(size: Sequence[float]) -> Json:
    """A CylinderPrimitive along z, by the full lengths of the box around it [m]."""
    return {**box(size), "bottom_scale": 1.0, "top_scale": 1.0}


def ball(radius: float) -> Json:
    """A SpherePrimitive [m]."""
    return {"pose": NOWHERE, "size": dict.fromkeys("xyz", 2.0 * radius), "color": LOAD_COLOUR}


def arrow(point: Sequence[float], vector: Sequence[float]) -> Json:
    """An ArrowPrimitive from a point of W [m], for a force in W [N]."""
    x, y, z = vector
    size = math.hypot(x, y, z)
    # Turns +x into the direction: half-way quaternion, and half a turn about z where the two are opposite.
    w, i, j, k = (size + x, 0.0, -z, y) if size + x > 1e-9 * max(size, 1.0) else (0.0, 0.0, 0.0, 1.0)
    norm = math.hypot(w, i, j, k)
    turn = {"x": i / norm, "y": j / norm, "z": k / norm, "w": w / norm}
    length = min(max(size * METRES_PER_NEWTON, 0.06), 0.4)
    return {
        "pose": {"position": dict(zip("xyz", point, strict=True)), "orientation": turn},
        "shaft_length": length - 0.04,
        "shaft_diameter": 0.012,
        "head_length": 0.04,
        "head_diameter": 0.032,
        "color": HAND_COLOUR,
    }


def line(tick: int, severity: Severity, text: str) -> Json:
    """A Log."""
    return {"timestamp": moment(tick), "level": LEVELS[severity], "message": text, "name": "pendant", "file": "", "line": 0}
