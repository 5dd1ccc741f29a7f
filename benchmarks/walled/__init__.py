"""Motions that the arm makes by itself, with walls in their way and without: what `benchmarks.wall_motions` draws and runs."""
