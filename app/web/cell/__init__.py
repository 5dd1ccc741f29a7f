"""The user's cell on the page: saved, loaded, undone, lent to a scenario and given back.

Uses files/, runs/, session/, web/widgets/.
"""
