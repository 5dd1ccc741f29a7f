"""Recordings of contacts and of free motion, and the baselines that the contact bench compares with."""
