"""The command `pendant` from its first moment on: until there is something to finish, Ctrl-C and SIGTERM end it at once."""

import signal

for number in (signal.SIGINT, signal.SIGTERM):  # what Python does by itself prints where it was
    signal.signal(number, signal.SIG_DFL)


def main() -> None:
    """Entry point."""
    from app import cli

    cli.main()


if __name__ == "__main__":
    main()
