"""References in joint and tool space. Uses arm/, braking/, compiled/, rigid_body/, sensing/."""
