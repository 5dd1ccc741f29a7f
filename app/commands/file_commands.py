"""`pendant check` and `pendant schema`: the files that people write, of every kind."""

import sys
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from app.commands.command_options import AnyFile, example
from app.files.checked import BadInput, load
from app.files.library import load_arm
from app.session.prepare import prepare
from app.session.session_file import KINDS, Session, Setup, find, opened, schema_of

CHECK_EXAMPLES = example(
    "pendant check my.yaml", "pendant check cell.yaml", "pendant check my-arm.yaml", "pendant check my-study.yaml"
)
SCHEMA_EXAMPLES = example("pendant schema > session.schema.json", "pendant schema configuration")


def schema_(
    kind: Annotated[str, typer.Argument(help="session, configuration, robot, tool or study.")] = "session",
) -> None:
    """Print the JSON schema of a kind of file, with which an editor completes and checks it."""
    from app.studies.study_file import Study

    kinds = {**KINDS, "study": Study}
    if kind not in kinds:
        raise BadInput("schema", "KIND", kind, f"one of {', '.join(kinds)}")
    sys.stdout.write(schema_of(kind, kinds[kind]))


def check_(
    file: Annotated[str, typer.Argument(help="A session, a configuration, a robot file or a study.")], any_file: AnyFile = False
) -> None:
    """Check a file, and simulate what it describes for a moment: a session, a configuration, a robot or a study's session."""
    from app.runs.runner import try_out

    path = find(file)
    raw = load(path, dict[str, object])
    if "chain" in raw:
        load_arm(path)
        what, setup = "robot", Setup(robot=str(path))
    elif "factors" in raw:
        from app.studies.plan import Plan
        from app.studies.study_file import open_study

        study, setup = open_study(str(path), anywhere=any_file)
        what = f"study of {Plan(study, setup, path.name).size} runs"
    elif "duration" in raw or "timeline" in raw or "title" in raw:
        what, setup = "session", opened(path, Session, any_file)
    else:
        what, setup = "configuration", opened(path, Setup, any_file)
    try_out(prepare(setup, path.name))
    Console().print(f"{escape(path.name)}: a valid {what}")
