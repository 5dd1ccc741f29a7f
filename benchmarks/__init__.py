"""Measurements. Each file prints one table and writes one JSON file; `--full` takes the full size."""
