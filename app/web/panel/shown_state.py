"""What the pendant shows of a state: light, words, texts, and which buttons can be pressed; one pure function of it."""

from typing import NamedTuple

from app.web.panel.panel_message import PanelText, Remembered, moves, said
from app.web.panel.state_words import ASKED, LEAVING_PERIODS, MOVES, RESET_NEEDED, SAFETY_WORDS, STOPPING, WORDS
from app.web.widgets.svg import Colour
from pendant.all_settings import Settings
from pendant.decision import Decision
from pendant.freedrive.origins import may_enter
from pendant.program.steps import ProgramState
from pendant.signals.sources import BUTTON
from pendant.tick.modes import TICK_RATE, Mode, Phase, Safety

ABOUT_TO_END = 1.0
"""A free-drive or restart period with less than this left is shown in amber [s]."""


class ShownState(NamedTuple):
    """What is shown, and what can be pressed."""

    name: str  # in large letters: the mode, of a stop what kind it is
    word: str  # what that means
    safety: str
    colour: Colour
    text: PanelText
    frees: bool = False  # the free-drive button begins free-drive, confirms it, or ends it
    leaves: bool = False
    resets: bool = False
    runs: bool = False  # the program begins or goes on
    pauses: bool = False
    stops: bool = False  # what moves the arm by itself can be ended: a program, the payload wizard
    jogs: bool = False  # a held button moves the arm


def shown(
    decision: Decision, settings: Settings, remembered: Remembered, *, paused: bool = False, failure: str = "", steps: int = 0
) -> ShownState:
    """What the pendant shows.

    Args:
        decision: of the newest tick.
        settings: as they are now.
        remembered: the events that still matter.
        paused: the simulation's clock stands still.
        failure: why nothing is simulated any more, or "".
        steps: of the program that would be run.
    """
    if failure:
        told = PanelText("The simulation broke down", f"{failure}. Press Start over, on the tab Lab.", Colour.RED)
        return ShownState("FAULT", "Nothing moves", "Unknown", Colour.RED, told)
    mode, stopped = decision.mode, decision.safety > Safety.REDUCED
    word, colour = ("Clock paused", Colour.AMBER) if paused else _state(decision)
    held = decision.program is ProgramState.PAUSED and mode is Mode.RUN
    free = mode is Mode.FREE_DRIVE or decision.phase is not Phase.OFF
    by_itself = decision.wizard.doing != ""
    idle = mode in (Mode.NORMAL, Mode.TEACH) and not (stopped or free or by_itself)
    return ShownState(
        name=SAFETY_WORDS[decision.safety].upper() if stopped else mode.replace("_", "-"),
        word=word,
        safety=RESET_NEEDED if mode is Mode.STOP and not stopped else SAFETY_WORDS[decision.safety],
        colour=colour,
        text=said(remembered, decision, settings, paused=paused),
        frees=not stopped and (free or may_enter(mode, BUTTON.source, settings)) and mode is not Mode.STOP,
        leaves=mode is Mode.FREE_DRIVE or decision.phase is Phase.SEQUENCE,
        resets=mode is Mode.STOP,
        runs=(idle and steps > 0 and not moves(decision)) or (held and not stopped),
        pauses=mode is Mode.RUN and decision.program is ProgramState.RUNNING,
        stops=mode is Mode.RUN or by_itself,
        jogs=idle,
    )


def _state(decision: Decision) -> tuple[str, Colour]:
    """The mode light's word and colour."""
    if decision.mode is Mode.STOP or decision.safety > Safety.REDUCED:
        return WORDS[Mode.STOP] if decision.static else STOPPING
    if any(p.name in LEAVING_PERIODS and p.ticks < ABOUT_TO_END * TICK_RATE for p in decision.periods):
        return "About to end", Colour.AMBER
    if decision.mode is Mode.RUN and decision.program is ProgramState.PAUSED:
        return "Program paused", Colour.AMBER
    if decision.phase in ASKED:
        return ASKED[decision.phase]
    if decision.wizard.doing or moves(decision):
        return MOVES
    return WORDS[decision.mode]
