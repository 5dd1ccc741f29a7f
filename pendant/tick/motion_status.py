"""What the control law did in a tick: a value for the next one, beside the estimate."""

import math
from typing import NamedTuple


class MotionStatus(NamedTuple):
    """Of the motions that were asked for, and of the posture that they led to."""

    done: int = 0  # id of the last move that the FOLLOW law finished, 0 before the first
    refused: str = ""  # why the FOLLOW law cannot do the move that it was given
    wall: str = ""  # the area at whose border it stopped that move; "" where it was refused for another reason
    commanded: bool = False  # the joints had torques that a script commands
    singularity: float = math.inf  # smallest singular value of the flange's Jacobian, a turn as 0.2 m; in free-drive only [m]


NO_MOTION = MotionStatus()
"""Before the first tick."""
