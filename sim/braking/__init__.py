"""The arm's own motions are braked before a border of the workspace. Uses rigid_body/."""
