"""Recordings read by time and topic, in memory that does not grow with their length; and played back. Uses files/, log/,
mcap_file/.
"""
