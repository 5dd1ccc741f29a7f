"""Ways of the tool centre point and of the joints, and the time law along them. Uses arm/, compiled/, rigid_body/."""
