"""A text with several programs, run as if a client had sent it."""

from app.urscript.language.program_text import programs_of
from app.urscript.language.trouble import ScriptTrouble
from app.urscript.running.script_runner import ScriptRunner


def run_text(scripts: ScriptRunner, text: str) -> None:
    """Run the programs of a text one in place of the other.

    Raises:
        ScriptTrouble: none of them can be run; of the first.
    """
    troubles: list[ScriptTrouble] = []
    programs = programs_of(text)
    for program in programs:
        try:
            scripts.offer(program)
        except ScriptTrouble as trouble:
            troubles.append(trouble)
    if len(troubles) == len(programs):
        raise troubles[0]
