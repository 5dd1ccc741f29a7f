"""Files that people write, into checked types; what the product ships."""
