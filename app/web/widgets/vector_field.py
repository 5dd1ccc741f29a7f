"""Three numbers in one field of the page."""

import viser


def vector(gui: viser.GuiApi, label: str, most: float, step: float, *, hint: str) -> viser.GuiVector3Handle:
    """A field of three numbers from -`most` to `most`, all 0 at first."""
    return gui.add_vector3(label, (0.0, 0.0, 0.0), min=(-most, -most, -most), max=(most, most, most), step=step, hint=hint)
