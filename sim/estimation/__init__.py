"""From measurements to what the controller knows. Uses arm/, compiled/, flange/, motion/, rigid_body/, sensing/."""
