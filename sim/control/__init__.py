"""The control laws of the modes. Uses arm/, compiled/, estimation/, motion/, rigid_body/."""
