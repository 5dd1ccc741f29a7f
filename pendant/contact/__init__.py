"""Changes in contact. Uses sensor/."""
