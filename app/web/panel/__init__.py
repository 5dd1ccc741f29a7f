"""The right side of the page: mode, button, countdowns, messages, the way back.

Uses urscript/running/, web/access/, web/scene/, web/tuning/, web/widgets/.
"""
