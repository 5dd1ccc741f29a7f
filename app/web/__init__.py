"""The web app: the picture of the arm, the hand that pushes it, and the pendant."""
