"""The pictures of the studies' pages, from data sets: python -m tools.study_pictures sequence-limit out/sequence-limit-quick"""

import sys
from pathlib import Path

from app.studies.study_file import open_study
from app.studies.study_report import Rows, figures

IMAGES = Path(__file__).parent.parent / "docs" / "images"
FIRST = 2
"""Figures of a study that its page shows."""


def draw(name: str, folder: Path, images: Path = IMAGES) -> list[Path]:
    """Write the first figures of a bundled study.

    Args:
        name: of the study.
        folder: that `pendant sweep --quick` wrote.
        images: where to.
    """
    study, _ = open_study(name, quick=True)
    written: list[Path] = []
    for k, (_, figure) in enumerate(figures(study, Rows(folder / "rows", study))[:FIRST]):
        path = images / f"study-{name}-{k + 1}.webp"
        figure.savefig(path, dpi=130, pil_kwargs={"quality": 80})
        written.append(path)
    return written


if __name__ == "__main__":
    draw(sys.argv[1], Path(sys.argv[2]))
