"""The docks on the left side. Uses files/, log/, runs/, web/scene/, web/widgets/."""
