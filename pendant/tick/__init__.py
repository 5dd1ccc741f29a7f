"""The words and values of a tick: modes, poses, what the controller knows, values against limits."""
