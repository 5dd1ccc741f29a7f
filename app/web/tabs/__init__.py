"""The docks on the left side. Uses files/, log/, web/scene/, web/widgets/."""
