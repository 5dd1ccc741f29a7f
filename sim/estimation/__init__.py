"""From measurements to what the controller knows. Uses arm/, compiled/, motion/, rigid_body/, sensing/."""
