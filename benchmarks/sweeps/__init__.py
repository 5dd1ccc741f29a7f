"""What the bench of studies does: processes that die, times, memory."""
