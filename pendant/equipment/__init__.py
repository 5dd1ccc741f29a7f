"""Tools and loads as values."""
