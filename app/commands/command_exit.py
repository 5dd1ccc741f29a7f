"""How a command ends: exit codes, and errors in one line."""

import sys

import typer

from app.ending import end_now, signal_that_came
from app.files.bad_input import BadInput
from app.files.extras import to_install

# Usage errors, whichever click typer was built on: the base of the one that typer exports.
UsageError: type[Exception] = typer.BadParameter.__mro__[1]

GIVEN_UP = 130
"""Exit code of what was interrupted."""


def run_command_line(app: typer.Typer) -> None:
    """Run a command line, and end the process: bad input is one line on standard error and exit code 2, never a traceback.

    Who asks for the end by Ctrl-C or SIGTERM gets it within three seconds; exit code 0 where something was served, else 128 and
    the signal's number.
    """
    code = _done(app)
    number = signal_that_came()
    if not number:
        sys.exit(code)
    end_now(refuse("stopped", 128 + number) if code == GIVEN_UP else code)  # a thread that hangs would keep the process


def _done(app: typer.Typer) -> int:
    """The exit code of the command."""
    try:
        return int(typer.main.get_command(app).main(sys.argv[1:] or ["--help"], prog_name="pendant", standalone_mode=False) or 0)
    except UsageError as error:
        text = error.format_message() if hasattr(error, "format_message") else str(error)  # type: ignore[attr-defined]
        return refuse(text)
    except BadInput as error:
        return refuse(str(error))
    except ModuleNotFoundError as error:
        command = "".join(sys.argv[1:2])
        wanted = to_install(error.name, command)
        if wanted is None:
            raise
        return refuse(f"{command} {wanted}")
    except (typer.Abort, KeyboardInterrupt):
        return GIVEN_UP
    except Exception:
        if signal_that_came():  # a library that was interrupted while it was loaded says something else
            return GIVEN_UP
        raise


def refuse(text: str, code: int = 2) -> int:
    """Say one line on standard error; the exit code to end with."""
    sys.stderr.write(" ".join(f"pendant: {text}".split()) + "\n")
    return code
