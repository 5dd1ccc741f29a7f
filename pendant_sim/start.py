"""The command `pendant` from its first moment on: until there is something to finish, Ctrl-C and SIGTERM end it at once."""

import signal
import sys

for number in (signal.SIGINT, signal.SIGTERM):  # what Python does by itself prints where it was
    signal.signal(number, signal.SIG_DFL)


def main() -> None:
    """Entry point."""
    from pendant_sim.ours import hidden

    trouble = hidden()
    if trouble is not None:
        sys.exit(f"pendant: {trouble}")
    from app import cli

    cli.main()


if __name__ == "__main__":
    main()
