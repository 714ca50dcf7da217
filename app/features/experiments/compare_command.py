"""`hexapods compare`: two settings of an experiment."""

import json
from typing import Annotated

from cyclopts import Parameter

from app.cli.options import AsJson, Data
from app.features.experiments.stored_summary import Results, read_summary
from hexapods.experiments.comparison import Unit
from hexapods.experiments.setting_comparison import Distance, compare_settings

DistanceOption = Annotated[
    Distance, Parameter(help="after 50 steps (total), or at time-out (finished)")
]
UnitOption = Annotated[
    Unit, Parameter(help="metres, half grid sides, or shares of greedy's distance")
]
_SETTING = "a setting: its name or key, or a part that no other has"


def compare(
    results: Results,
    a: Annotated[str, Parameter(name="A", help=_SETTING)],
    b: Annotated[str, Parameter(name="B", help=_SETTING)],
    /,
    *,
    distance: DistanceOption = "total",
    unit: UnitOption = "m",
    data: Data = None,
    as_json: AsJson = False,
) -> int:
    """Compare two settings of an experiment: difference, its interval, and seeds still missing.

    Raises:
        HexapodError: if there is no such experiment or setting.
    """
    compared = compare_settings(read_summary(results, data), a, b, distance=distance, unit=unit)
    if as_json:
        print(json.dumps(compared.as_json()))
    else:
        print("\n".join(filter(None, compared.words)))
    return 0
