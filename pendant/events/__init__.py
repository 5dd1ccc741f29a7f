"""What an event and its row are, and what a state machine makes of a tick."""
