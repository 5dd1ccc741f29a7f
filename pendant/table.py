"""The one event table: effect on the mode, severity, texts, what clears it, who may override. Interfaces render from it."""

from pendant.entry_rows import ENTRY
from pendant.event_row import Row
from pendant.events import Event, Kind
from pendant.free_drive_rows import FREE_DRIVE
from pendant.program_rows import PROGRAM
from pendant.safety_rows import SAFETY

TABLE: dict[Kind, Row] = {**ENTRY, **FREE_DRIVE, **SAFETY, **PROGRAM}


def render(event: Event) -> tuple[str, str]:
    """Headline and guidance of an event, with its numbers."""
    row = TABLE[event.kind]
    guidance = row.guidance
    if row.variant is not None and event.values[row.variant[0]]:
        guidance = row.variant[1]
    return row.headline.format_map(event.values), guidance.format_map(event.values)
