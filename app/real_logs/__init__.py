"""Logs of real arms: read and mended; an arm fitted to them, and held against them. Uses files/, log/, log_reading/, report/,
session/.
"""
