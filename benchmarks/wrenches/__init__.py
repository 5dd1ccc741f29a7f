"""Whose force moves the arm: what the observer is measured against."""
