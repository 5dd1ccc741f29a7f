"""What a script that waits for its client costs in a tick, side by side with none."""

import time

from benchmarks.common import Report, main
from benchmarks.script_hostile import Course

WAITING = """def waiting():
  global offset = 0
  global inner = 0
  def read(k):
    return read_input_integer_register(k + offset)
  end
  def ready():
    write_output_integer_register(0 + offset, 1)
  end
  def command():
    cmd = read(0)
    if cmd == 0:
      enter_critical
      cmd = inner
      inner = 0
      exit_critical
    end
    return cmd
  end
  going = True
  doing = False
  while going:
    cmd = command()
    if cmd == 24 or cmd == 11 or cmd == 9 or cmd == 10 or cmd == 6 or cmd == 25 or cmd == 26 or cmd == 27 or cmd == 38:
      ready()
    else:
      if cmd == 0:
        doing = False
        ready()
      end
    end
    if cmd != 66:
      sync()
    end
  end
end
"""
"""A loop of the kind that clients upload: it reads a register, finds no command, says that it is ready, and waits for a tick."""


def cost(course: Course, ticks: int) -> float:
    """Of the script's part of a tick, on the processor [us]; the least of five runs, as others use the machine."""
    best = float("inf")
    for _ in range(5):
        begun = time.thread_time_ns()
        for tick in range(ticks):
            course.runner.wishes(tick)
        best = min(best, (time.thread_time_ns() - begun) / 1e3 / ticks)
    return best


def measure(report: Report) -> None:
    """Fill the report."""
    ticks = 20000 if report.options.full else 4000
    course = Course()
    none = cost(course, ticks)
    course.runner.offer(WAITING)
    running = cost(course, ticks)
    report.row("no script: part of a tick", none, "us", n=ticks)
    report.row("script that waits: part of a tick", running, "us", n=ticks)
    report.row("script that waits: more than none", running - none, "us", at_most=10.0, n=ticks)


if __name__ == "__main__":
    main("script_cost", measure)
