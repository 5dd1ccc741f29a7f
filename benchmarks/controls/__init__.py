"""Runs of the joint control, of which its bench makes rows."""
