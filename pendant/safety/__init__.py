"""The robot's limits, and protective stops of a robot that does not do what it should, or meets something."""
