"""The colours of what pulls at the free arm, on the page and in reports."""

PULL_COLOURS = ("#bdbdbd", "#0072b2", "#56b4e9", "#d55e00", "#f0e442")
"""Of the fields of `pendant.guided.pull.CauseShares`. Okabe and Ito (2008): colour-blind eyes tell them apart, too."""
