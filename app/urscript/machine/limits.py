"""How much a script may have and do. Each limit is a clear error; none of them is near what clients' programs need."""

NODES_A_TICK = 3000
"""Steps of the evaluator in one tick, of all threads together: a few tenths of a millisecond. What one statement takes beyond
is made up for in the ticks after it."""

NODES_WITHOUT_TIME = 500 * NODES_A_TICK
"""Steps of one thread in a row in which no time passes for the robot, before people are told: a second when it runs alone."""

NODES_OF_START = 60
"""Steps that the start of a thread counts, as long as it takes the evaluator."""

HEAVY = 80
"""Steps that are done without looking at the clock; longer statements are done in parts."""

MOST_THREADS = 50
DEEPEST_CALLS = 100
LONGEST_LIST = 1000
"""Elements of a list, with those of lists in it."""
LONGEST_TEXT = 1023
"""Characters; longer ones are an error on the robot, too (URScript manual, str_cat)."""
MOST_SLOTS = 8000
"""Variables of all running functions."""
MOST_MEMORY = 100_000
"""Numbers and characters that all variables hold together."""
MEMORY_LOOK = 50_000
"""Numbers and characters that are made between two looks at what is held."""
MOST_FUNCTIONS = 2000
MOST_MESSAGES = 100
"""A second, to log and clients; what is beyond is left out, and told."""
