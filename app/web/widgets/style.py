"""How single controls look, by their ids; everything else of the look stands in assets/page/page.css."""

from collections.abc import Iterable, Sequence

QUIET = (
    "background:rgba(134,142,150,.12);color:inherit;border:1px solid rgba(134,142,150,.28);"
    "--button-hover:rgba(134,142,150,.26)!important;--button-hover-color:inherit!important"
)
"""How a button looks that needs no eye."""

BELOW, UP = "padding-bottom:8px!important", "margin-top:-52px!important"
"""Of a button 44 pixels high what is below it, and what brings the next one up beside it."""


def sheet(stop: str, free_drive: str, quiet: Iterable[str], *, large: Iterable[str] = ()) -> str:
    """The style sheet of the page; the arguments are the ids of its controls.

    `quiet` are the buttons that need no eye, `large` those among them that stop or free the arm: a finger finds them.

    The part of the right column that has the stop but not the free-drive button gets the height it needs and keeps it (viser
    gives stacked panels equal shares), and the column cannot be folded away: the emergency stop is always in sight. Its one tab
    has no strip, and the column no handle: the height goes to what is always needed.
    """
    main, low = f':has([id="{free_drive}"])', f':has([id="{stop}"])'
    plain = ",".join(f'[id="{button}"]' for button in quiet)
    easy = ",".join(f'[id="{button}"]' for button in large) or "[id=none]"
    return f"""<style data-pd-stop="{stop}" data-pd-free-drive="{free_drive}">
{main}>{low}:not({main}){{flex:0 0 152px!important}} {low}>{main}:not({low}){{flex:1 1 0!important}}
[data-dock-group]{low}>[role=tablist],[data-dock-region]{low}>div:first-child{{display:none!important}}
[style*="right: 0px"]{low} [aria-label="Collapse panel area"]{{display:none!important}}
[id="{free_drive}"]{{height:56px!important;font-size:16px;border-radius:8px;user-select:none;touch-action:none}}
[id="{stop}"]{{height:64px!important;font-size:17px;font-weight:700;letter-spacing:.05em;border-radius:8px}}
{plain}{{{QUIET};height:var(--pd-button)!important;border-radius:8px}} {plain.replace("]", "]:disabled")}{{opacity:.6}}
:root:has([data-pd-watching]) :is(.mantine-Button-root,.mantine-Slider-root):not([id="{stop}"]){{opacity:.55}}
{easy}{{height:44px!important}}
</style>"""


def beside(button: str) -> str:
    """Put the button with this id at the end of the line above it."""
    return (
        f'<style>div:has(>[id="{button}"]){{margin:-46px 12px 8px auto!important;padding:0!important;width:88px}}'
        f'[id="{button}"]{{height:36px!important;font-size:13px;padding:0;border-radius:6px;{QUIET}}}'
        f':root [id="{button}"]:not(:disabled){{opacity:1!important}}</style>'
    )


def unseen(control: str) -> str:
    """Keep the list with this id from sight: rows that stand beside it choose from it, for keyboard and pointer."""
    return f'<style>div:has(>div>div>div>div>[id="{control}"]){{display:none!important}}</style>'


def shown(button: str, visible: bool) -> str:
    """Show the upload button with this id, or hide it: viser shows one always."""
    return "" if visible else f'<style>div:has(>[id="{button}"]){{display:none}}</style>'


def pairs(buttons: list[str]) -> str:
    """Put every two of these buttons, which are held, beside each other, for a finger; it may begin a scroll on them."""
    left, right = (",".join(f'[id="{button}"]' for button in buttons[k::2]) for k in (0, 1))
    both = f"{left},{right}"
    return (
        f'<style data-pd-held="{" ".join(buttons)}">'
        f"div:has(>:is({left})){{width:calc(50% - 15px)!important;margin-right:0!important;{BELOW}}}"
        f"div:has(>:is({right})){{width:calc(50% - 15px)!important;margin-left:calc(50% + 3px)!important;{BELOW};{UP}}}"
        f":is({both}){{height:44px!important;font-size:13px;padding:0 4px;touch-action:pan-y;user-select:none;{QUIET}}}</style>"
    )


def row(buttons: Sequence[str], shares: Sequence[float], *, held: str) -> str:
    """Put these buttons beside each other, each with its share of the width, for a finger; one of them is held."""
    room = f"(100% - {24 + 6 * (len(buttons) - 1)}px)"
    rules = ""
    for place, (button, share) in enumerate(zip(buttons, shares, strict=True)):
        left, up = sum(shares[:place]), f"{UP};" if place else ""
        rules += (
            f'div:has(>[id="{button}"]){{width:calc({room}*{share:g})!important;{BELOW};{up}'
            f"margin-left:calc(12px + {room}*{left:g} + {6 * place}px)!important;margin-right:0!important}}"
        )
    every = ",".join(f'[id="{button}"]' for button in buttons)
    look = f"height:44px!important;font-size:13px;padding:0 2px;user-select:none;{QUIET}"
    return f'<style data-pd-held="{held}">{rules}:is({every}){{{look}}} :is({every}):disabled{{opacity:.6}}</style>'


def held(button: str) -> str:
    """The button with this id is held, for a finger as the pairs."""
    return (
        f'<style data-pd-held="{button}">[id="{button}"]{{height:44px!important;font-size:13px;touch-action:pan-y;'
        f"user-select:none;{QUIET}}}</style>"
    )
