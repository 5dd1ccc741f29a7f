"""Lead the elbow of an arm with seven joints

One hand holds the flange while another leads the elbow aside.
"""

import sys

from matplotlib.figure import Figure

from pendant_sim import load_arm, read, run

if __name__ == "__main__":
    arm = load_arm("iiwa7")
    run("elbow-led", "13_seven_joints")
    log = read("13_seven_joints/log.mcap")
    axes = (figure := Figure(layout="constrained")).add_subplot(xlabel="time [s]", ylabel="angle since the beginning [rad]")
    axes.plot(log.t, log.truth["q"] - log.truth["q"][0], label=arm.chain.joints)
    axes.legend()
    figure.savefig("13_seven_joints.svg")
    sys.stdout.write(f"{arm.title}, {len(arm.chain.joints)} joints, reach {arm.reach} m, payload {arm.payload} kg\n")
