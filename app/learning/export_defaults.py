"""What an export does unless it is told otherwise; apart from the export, so that the command line starts without it."""

RATE = 25
"""Rows a second: about the rate of a camera."""

TASK = "Lead the arm by hand."
