"""JUnit XML of sessions that ran, for continuous integration: one suite for each session, one case for each expectation."""

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

from app.files.checked import ABSENT, BadInput
from app.runs.runner import RunOutcome


def junit(outcomes: dict[str, RunOutcome], refused: Sequence[str] = ()) -> str:
    """The document, for outcomes by the name of their session; `refused`: error lines of files that could not be run."""
    root = ElementTree.Element("testsuites", name="pendant")
    total = failed = 0
    for name, outcome in outcomes.items():
        unmet = sum(not verdict.passed for verdict in outcome.verdicts)
        total, failed = total + len(outcome.verdicts), failed + unmet
        numbers = {"tests": str(len(outcome.verdicts)), "failures": str(unmet), "time": f"{outcome.took:.3f}"}
        suite = ElementTree.SubElement(root, "testsuite", {"name": name, **numbers})
        for verdict in outcome.verdicts:
            case = ElementTree.SubElement(suite, "testcase", classname=name, name=_plain(verdict.expected), time="0")
            if not verdict.passed:
                ElementTree.SubElement(case, "failure", message=_plain(verdict.seen)).text = _plain(verdict.expected)
    for line in refused:
        suite = ElementTree.SubElement(root, "testsuite", name=_plain(line.partition(":")[0]), tests="1", errors="1")
        case = ElementTree.SubElement(suite, "testcase", classname=suite.get("name", ""), name="can be used", time="0")
        ElementTree.SubElement(case, "error", message=_plain(line))
    if refused:
        total += len(refused)
        root.set("errors", str(len(refused)))
    root.set("tests", str(total))
    root.set("failures", str(failed))
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def write(path: Path, outcomes: dict[str, RunOutcome], refused: Sequence[str] = ()) -> None:
    """Write the document, as `junit` makes it.

    Raises:
        BadInput: it cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(junit(outcomes, refused), encoding="utf-8")
    except OSError as error:
        raise BadInput(str(path), "", ABSENT, f"cannot be written ({error.strerror})") from None


def _plain(text: str) -> str:
    """Without the control characters that XML cannot hold."""
    return "".join(c if c.isprintable() else " " for c in text)
