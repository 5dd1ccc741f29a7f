"""The picture, and the hand in it."""
