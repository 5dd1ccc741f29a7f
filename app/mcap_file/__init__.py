"""MCAP files: written chunk by chunk, read by time and topic in little memory, mended where they are cut. Uses files/."""
