"""From measurements to what the controller knows. Uses arm/, motion/, rigid_body/, sensing/."""
