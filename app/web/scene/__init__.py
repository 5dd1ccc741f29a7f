"""The picture, and the hand in it. Uses web/access/."""
