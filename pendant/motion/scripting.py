"""Who sees, in every tick, what the running script wants: its motions are done one after the other while it says so."""

from pendant.motion.script_requests import ForceMode, Guided, PathOffset, Scripted, ScriptedMove
from pendant.program.sequencer import Sequencer
from pendant.program.steps import RunScript

SILENT = "no word from the script"


class Scripting:
    """Keeps the motion that the script asked for last going in the sequencer's only step.

    Args:
        sequencer: of the program whose step the script is.

    Attributes:
        done: number of the last motion that is done.
    """

    __slots__ = ("_asked", "_feeling", "_force", "_offset", "_sequencer", "_silent", "done")

    def __init__(self, sequencer: Sequencer) -> None:
        self._sequencer = sequencer
        self._asked: ScriptedMove | None = None  # that is being done, as the script said it
        self._silent = 0  # ticks without a word
        self._feeling = False
        self._force: ForceMode | None = None
        self._offset: PathOffset | None = None
        self.done = 0

    def begin(self) -> None:
        """The program starts or goes on: what the script wants is begun, or begun again."""
        self._asked, self._silent, self._feeling, self._force, self._offset = None, 0, False, None, None

    @property
    def feeling(self) -> bool:
        """The script wants to know of changes in contact."""
        return self._feeling and self._sequencer.scripted

    @property
    def force(self) -> ForceMode | None:
        """How the script has the arm push while it moves."""
        return self._force if self._sequencer.scripted else None

    @property
    def offset(self) -> PathOffset | None:
        """How far beside its motions the script has the arm go."""
        return self._offset if self._sequencer.scripted else None

    @property
    def guided(self) -> Guided | None:
        """How the script has the arm guided by hand."""
        move = self._sequencer.move
        return move if isinstance(move, Guided) else None

    def equips(self, wish: Scripted | None) -> bool:
        """Tool and payload in this tick's inputs are the running script's own; anybody else stops the program first."""
        return wish is not None and wish.equips and self._sequencer.scripted

    def step(self, move_done: int, wish: Scripted | None, silence: int) -> str:
        """One tick of a running program whose step is a script.

        Args:
            move_done: id of the last move that the FOLLOW law finished.
            wish: of the script.
            silence: longest time without one [ticks].

        Returns:
            Why it cannot go on, or "".
        """
        sequencer, asked = self._sequencer, self._asked
        if wish is None:
            self._silent += 1
            return SILENT if self._silent > silence else ""
        self._silent = 0
        self._feeling, self._force, self._offset = wish.feeling, wish.force, wish.offset
        move = sequencer.move
        if asked is not None and move is not None and (move.id == move_done or isinstance(move, RunScript)):
            self.done = max(self.done, asked.id)
        wanted = wish.move
        if wanted is None or wanted is asked or move is None or (asked is not None and wanted.id <= asked.id):
            return ""
        if isinstance(asked, Guided) and not isinstance(move, RunScript):
            return ""  # free-drive is left first
        self._asked = wanted
        sequencer.ask(wanted)
        return ""
