"""Recordings on the page: made, replayed, downloaded, exported. Uses files/, learning/, log/, web/panel/, web/scene/,
web/widgets/.
"""
