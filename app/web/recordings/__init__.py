"""Recordings on the page: made, replayed, downloaded, exported. Uses files/, learning/, log/, log_reading/, web/panel/,
web/scene/, web/widgets/.
"""
