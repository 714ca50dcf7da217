"""`hexapods figure`: a figure of an experiment for a paper."""

import json
from typing import Annotated

from cyclopts import Parameter

from app.cli.files import check_writable, size_text, write_whole
from app.cli.options import AsJson, Data
from app.features.experiments.compare_command import DistanceOption, UnitOption
from app.features.experiments.stored_summary import Results, read_summary
from hexapods.experiments.figures.config import Columns, FigureConfig, Kind
from hexapods.experiments.figures.files import FILE_ENDINGS, paper_figure

_ENDINGS = ", ".join(f".{ending}" for ending in FILE_ENDINGS)


def figure(
    results: Results,
    /,
    *,
    kind: Annotated[
        Kind,
        Parameter(help="every seed, two settings and their difference, or performance profiles"),
    ] = "seeds",
    columns: Annotated[
        Columns, Parameter(help="columns of a page that it fills: 85 or 178 mm")
    ] = 1,
    setting: Annotated[
        tuple[str, ...],
        Parameter(help="name or key of a setting, once for each (default: all with a distance)"),
    ] = (),
    distance: DistanceOption = "total",
    unit: UnitOption = "m",
    out: Annotated[
        str, Parameter(metavar="FILE", help=f"file to write: {_ENDINGS}; .zip has all")
    ] = "figure.zip",
    data: Data = None,
    as_json: AsJson = False,
) -> int:
    """Draw a figure of an experiment for a paper, with its caption, data and command.

    Raises:
        HexapodError: if there is no such experiment or setting, or Matplotlib is not installed.
    """
    config = FigureConfig(
        kind=kind, columns=columns, settings=setting, distance=distance, unit=unit
    )
    check_writable(out)
    drawn = paper_figure(read_summary(results, data), config)
    content = drawn.to_bytes(out.rpartition(".")[2].lower() if "." in out else "")
    write_whole(out, content)
    if as_json:
        print(json.dumps({"file": out, "bytes": len(content), "caption": drawn.caption.strip()}))
    else:
        print(f"The figure is in {out} ({size_text(len(content))}).\n{drawn.caption.strip()}")
    return 0
