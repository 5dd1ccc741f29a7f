"""What may ask for free-drive, and the devices that a hand holds. Uses limits/, sensor/."""
