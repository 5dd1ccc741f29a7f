"""Numbered examples; `python -m tools.gallery` runs each and keeps its picture."""
