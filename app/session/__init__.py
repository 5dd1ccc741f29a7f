"""Sessions: what to simulate, what happens when, what is expected. Uses files/."""
