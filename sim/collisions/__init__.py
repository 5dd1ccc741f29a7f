"""What may stop the arm: what it hits, as its joints feel it, and how it moves. Uses arm/, braking/, compiled/, estimation/,
rigid_body/, sensing/.
"""
