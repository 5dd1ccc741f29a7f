"""The laboratory: scenarios, the true arm and world, wiring. Uses files/, runs/, session/, web/scene/, web/widgets/."""
