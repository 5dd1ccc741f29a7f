"""The messages a browser may send, as strict types: anything that does not decode into one of them is refused."""

from typing import Literal

import msgspec

Pair = tuple[float, float]
Triple = tuple[float, float, float]


class Message(msgspec.Struct, tag_field="type", forbid_unknown_fields=True):
    """Base of the admitted messages. Names and fields are those of viser's dataclasses; a test compares them."""


class Camera(Message, tag="ViewerCameraMessage"):
    """Where the client looks from; it concerns this client alone."""

    wxyz: tuple[float, float, float, float]
    position: Triple
    fov: float
    near: float
    far: float
    image_height: int
    image_width: int
    look_at: Triple
    up_direction: Triple


class Update(Message, tag="GuiUpdateMessage"):
    """A control was used."""

    uuid: str
    updates: dict[str, bool | int | float | str | Triple]


class HoldMessage(Message, tag="GuiButtonHoldMessage"):
    """A button is held: sent again and again."""

    uuid: str
    frequency: float


class CommandTrigger(Message, tag="CommandTriggerMessage"):
    """A key was pressed, or a line of the palette chosen."""

    uuid: str


class Drag(Message, tag="SceneNodeDragMessage"):
    """A part of the scene is dragged."""

    phase: Literal["start", "update", "end"]
    name: str
    instance_index: None
    start_position: Triple
    start_screen_pos: Pair
    end_position: Triple
    end_screen_pos: Pair
    button: Literal["left", "middle", "right"]
    modifier: str | None
    owner: str = ""


class HandlesMoved(Message, tag="TransformControlsUpdateMessage"):
    """Handles in the picture are moved: their pose."""

    name: str
    wxyz: tuple[float, float, float, float]
    position: Triple
    owner: str = ""


class HandlesTaken(Message, tag="TransformControlsDragStartMessage"):
    """Handles in the picture are taken hold of."""

    name: str
    owner: str = ""


class HandlesLetGo(Message, tag="TransformControlsDragEndMessage"):
    """Handles in the picture are let go."""

    name: str
    owner: str = ""


class Upload(Message, tag="FileTransferStartUpload"):
    """A file is about to come."""

    source_component_uuid: str
    transfer_uuid: str
    filename: str
    mime_type: str
    part_count: int
    size_bytes: int


class UploadPart(Message, tag="FileTransferPart"):
    """The content of a file."""

    source_component_uuid: str
    transfer_uuid: str
    part_index: int
    content: bytes


Handles = HandlesMoved | HandlesTaken | HandlesLetGo

Admitted = Camera | Update | HoldMessage | CommandTrigger | Drag | Handles | Upload | UploadPart

_decoder = msgspec.msgpack.Decoder(Admitted)
_encoder = msgspec.msgpack.Encoder()


def decode(raw: bytes) -> Admitted | None:
    """The message in `raw`, or None if it is none of the admitted types or has a field too many, too few or of another type."""
    try:
        return _decoder.decode(raw)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return None


def encode(message: Admitted) -> bytes:
    """The bytes handed on to viser: written anew, so that nothing reaches it that was not understood here."""
    return _encoder.encode(message)
