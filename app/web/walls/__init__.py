"""Walls and areas made on the page: list, values, handles in the picture. Uses web/access/, web/scene/, web/widgets/."""
