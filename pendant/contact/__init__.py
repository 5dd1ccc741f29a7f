"""Changes in contact."""
