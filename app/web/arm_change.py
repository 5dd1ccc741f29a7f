"""What the page needs to go over to another arm without a new start of the server (app.serving.ServedArms)."""

from contextlib import suppress
from typing import NamedTuple, Protocol

from app.files.bad_input import BadInput
from app.files.library import FOOT, mesh_path
from app.kept_setup import Cell, Keeper
from app.robot_interface.interfaces import RobotInterfaces
from app.session.prepare import Prepared
from app.urscript.running.script_runner import ScriptRunner
from sim.arm.arm_file import Arm


class ReadyArm(NamedTuple):
    """An arm that can be brought in, as it begins: as it was kept, or as shipped."""

    prepared: Prepared
    keeper: Keeper | None
    cell: Cell | None
    meshes: dict[str, bytes]


class BroughtArm(NamedTuple):
    """What stands around the arm that now runs."""

    interfaces: RobotInterfaces | None
    scripts: ScriptRunner | None
    said: str  # what became of the network and of a recording; "": there was neither


class ArmChange(Protocol):
    """Brings another arm into the loop that is served. Its methods wait, so they are called on threads of their own."""

    @property
    def names(self) -> tuple[str, ...]:
        """The arms that there are."""
        ...

    def ready(self, name: str, held: Cell | None = None) -> ReadyArm:
        """An arm, checked and ready, with the cell that the page `held` of it, or else that was kept.

        Raises:
            BadInput: it cannot be simulated like that.
        """
        ...

    def bring(self, arm: ReadyArm) -> BroughtArm:
        """Let it run in place of the one that does; returns when its first tick is done."""
        ...


def meshes_of(arm: Arm) -> dict[str, bytes]:
    """The pictures of an arm's links; of one that nobody drew its outline or its shapes."""
    found: dict[str, bytes] = {}
    for part in (FOOT, *arm.chain.joints):
        with suppress(BadInput):
            found[part] = mesh_path(arm, part).read_bytes()
    if len(found) <= arm.n:
        from assets.build_meshes import pictures

        found = {part: picture.glb() for part, picture in pictures(arm).items()} | found
    return found
