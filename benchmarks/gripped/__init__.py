"""Parts in a gripper: what the bench `gripper` sets up and does."""
