"""See a contact in force and acceleration

In a contact they change against each other, and no motion of the arm makes them do so. The program speeds the tool up first,
and nothing is told. Then a hand pushes against the tool.
"""

import sys

from matplotlib.figure import Figure

from pendant_sim import read, run

if __name__ == "__main__":
    outcome = run("contact-4a", "08_contact")
    log = read("08_contact/log.mcap")
    gained = next(event for event in outcome.events if event.kind.value == "contact_gained")
    figure = Figure(layout="constrained")
    above, below = figure.subplots(2, sharex=True)
    above.plot(log.t, log.state["w_sensor"][:, :3], linewidth=0.8)
    above.set_ylabel("force at the flange [N]")
    below.plot(log.t, log.state["a_F"], linewidth=0.8)
    below.set(xlabel="time [s]", ylabel="specific force [m/s²]")
    for axes in (above, below):
        axes.axvline(0.002 * gained.tick, color="red")
    figure.savefig("08_contact.svg")
    sys.stdout.write(f"{gained.values['part']} touched, told {1000 * (0.002 * gained.tick - 2.3):.0f} ms after the push began\n")
