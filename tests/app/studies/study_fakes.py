"""A small study, and rows for it without running anything."""

from typing import Any

from app.files.checked import convert
from app.session.session_file import Session
from app.studies.plan import Plan
from app.studies.study_file import Study

BASE: dict[str, Any] = {
    "title": "t",
    "duration": 0.1,
    "timeline": [{"at": 0.02, "do": "press", "control": "free_drive"}],
}
FIELDS: dict[str, Any] = {
    "title": "Small",
    "session": BASE,
    "factors": [
        {"name": "mass", "kind": "list", "field": "payload_true.mass", "unit": "kg", "values": [0.0, 1.0]},
        {"name": "height", "kind": "uniform", "field": "posture[1]", "from": -1.4, "to": -1.0},
        {"name": "sequence", "kind": "list", "field": "settings.sequence.on", "values": [True, False]},
    ],
    "samples": 2,
    "seeds": 2,
    "measures": [
        {"name": "way", "measure": "displacement", "unit": "m"},
        {"name": "refused", "measure": "happens", "kinds": ["refused_*"]},
    ],
    "show": [
        {"show": "curve", "of": "way", "over": "mass"},
        {"show": "curve", "of": "refused", "over": "height", "by": "sequence"},
        {"show": "heat_map", "of": "way", "over": ["mass", "sequence"]},
        {"show": "roc", "of": "refused", "over": "sequence", "right": "mass", "at_least": 0.5},
        {"show": "sensitivity", "of": "way"},
    ],
    "worst": {"of": "way"},
}


def study(**fields: Any) -> Study:
    return convert({**FIELDS, **fields}, Study, "study")


def base(**fields: Any) -> Session:
    posture = [0.0, -1.2, 1.5, -1.87, -1.57, 0.0]
    return convert({**BASE, "posture": posture, **fields}, Session, "session")


def plan(**fields: Any) -> Plan:
    return Plan(study(**fields), base(), "study.yaml")
