"""Random motions, and what must hold for each of them."""
