"""What the arm hits, as its joints feel it. Uses arm/, compiled/, estimation/, rigid_body/, sensing/."""
