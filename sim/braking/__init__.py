"""The arm's own motions are braked before a border of the workspace. Uses compiled/, rigid_body/."""
