"""References in joint and tool space. Uses arm/, compiled/, rigid_body/, sensing/."""
