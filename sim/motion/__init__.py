"""References in joint and tool space. Uses arm/, braking/, paths/, rigid_body/, sensing/."""
