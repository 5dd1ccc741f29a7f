"""An arm's numbers from how it moved: friction, rotor inertia, torque constant, links and load. Uses arm/, estimation/,
rigid_body/."""
