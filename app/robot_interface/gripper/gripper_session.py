"""One connection to the port of the gripper."""

from app.robot_interface.gripper.gripper_registers import LONGEST, GripperLines, GripperRegisters
from app.robot_interface.transport.outbox import Outbox
from app.robot_interface.transport.peers import Peer, Peers
from app.robot_interface.transport.tcp_port import Farewell


class GripperSession:
    """See `app.robot_interface.transport.tcp_port.Conversation`.

    Raises:
        Farewell: the robot has no gripper.
    """

    def __init__(self, registers: GripperRegisters, peers: Peers, peer: Peer, outbox: Outbox) -> None:
        if not registers.there:
            raise Farewell("no gripper is mounted")
        self._lines, self._peers, self._peer, self._outbox = GripperLines(registers), peers, peer, outbox

    async def hear(self, data: bytes) -> None:
        """Answer the lines that are whole."""
        answer = self._lines.hear(data)
        if answer is None:
            raise Farewell(f"a line of more than {LONGEST} bytes")
        if answer:
            line, said = data.decode("ascii", "replace").strip(), answer.decode().strip()
            self._peers.note(self._peer.interface, self._peer.number, f"{line} -> {said}")
            self._outbox.send(answer)

    def over(self) -> None:
        """Nothing is kept for a client."""
