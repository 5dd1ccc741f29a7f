"""What an event and its row are."""
