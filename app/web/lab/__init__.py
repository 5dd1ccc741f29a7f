"""The laboratory: scenarios, true arm, world, wires. Uses files/, robot_interface/, runs/, session/, web/scene/, web/widgets/."""
