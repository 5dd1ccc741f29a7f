"""Run a script

A program in the robot's own language, URScript, is sent from Python and moves the joints.
"""

import sys

from matplotlib.figure import Figure

from pendant_sim import read, run, session

PROGRAM = """\
def wave():
  q = get_target_joint_positions()
  i = 0
  while i < 2:
    movej([q[0] + 0.4, q[1], q[2], q[3] - 0.3, q[4], q[5]], a=1.5, v=0.8)
    movej(q, a=1.5, v=0.8)
    i = i + 1
  end
  textmsg("waved ", i)
end
"""

if __name__ == "__main__":
    script = {"at": 0.3, "do": "script", "text": PROGRAM, "tells": ["waved 2"]}
    outcome = run(session({"title": "a script", "duration": 6.0, "timeline": [script]}), "10_a_script")
    log = read("10_a_script/log.mcap")
    axes = (figure := Figure(layout="constrained")).add_subplot(xlabel="time [s]", ylabel="angle of the joints [rad]")
    axes.plot(log.t, log.state["q"] - log.state["q"][0], label=["base", "shoulder", "elbow", "wrist 1", "wrist 2", "wrist 3"])
    axes.legend(fontsize=7)
    figure.savefig("10_a_script.svg")
    sys.stdout.write(f"the program said what it should: {outcome.passed}\n")
