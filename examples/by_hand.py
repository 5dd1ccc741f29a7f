"""A simulation stepped by hand: free the arm, push its flange, see how far it went. Run: python -m examples.by_hand"""

import math
import sys

from pendant_sim import Button, Push, session, step, stepped

if __name__ == "__main__":
    simulation = stepped(session({"title": "by hand", "duration": 1.0, "settings": {"activation.period": 0.2}}))
    step(simulation, 700, held=[Button.FREE_DRIVE])
    start = simulation.snapshot()
    step(simulation, 60, held=[Button.FREE_DRIVE], touches=[Push("flange", (0.0, 0.0, 0.0), (0.0, 15.0, 0.0))])
    now = simulation.snapshot()
    way = math.dist(start.truth_links[-1, :3], now.truth_links[-1, :3])
    sys.stdout.write(f"{now.decision.mode}: the flange went {1000 * way:.0f} mm\n")
