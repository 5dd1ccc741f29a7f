"""References in joint and tool space. Uses arm/, rigid_body/, sensing/."""
