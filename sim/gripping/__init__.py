"""Gripping: where fingers or a cup meet a part, how firmly they hold it, how the fingers move. Uses arm/, compiled/."""
