"""The wrench at the flange, and whose it is: hypotheses and their odds. Uses arm/, compiled/, rigid_body/, sensing/."""
