"""Defaults of an export, in a module of their own, so that the command line starts without loading the export."""

RATE = 25
"""Rows a second: about the rate of a camera."""

TASK = "Lead the arm by hand."
