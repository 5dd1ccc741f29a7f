"""Studies: one session under many conditions, as rows of a data set and a report.

Uses engine/, files/, log/, log_reading/, report/, runs/, session/.
"""
