"""The control laws of the modes. Uses arm/, estimation/, motion/, rigid_body/, sensing/."""
