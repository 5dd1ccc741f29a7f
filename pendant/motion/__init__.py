"""Motions that a script asks for while it runs, and who sees that it still does. Uses program/."""
