"""Routes of an experiment's settings compared, and of figures for papers."""

import json
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Literal, TypeVar

from fastapi import Query
from starlette.responses import JSONResponse, Response

from app.api.contract import ATTACHMENT, BINARY, answers
from app.api.deps import ServicesDep
from app.api.formats import attachment
from app.api.policy import WATCH_RUN, api_router, policy
from app.api.runs import RunPath, find
from app.api.work import ANALYSIS, ENCODING
from app.features.experiments.response_models import SettingComparisonView
from app.storage.errors import Conflict
from hexapods.domain.errors import DamagedFile, HexapodError
from hexapods.domain.records import to_json
from hexapods.experiments.comparison import Unit
from hexapods.experiments.config import SUMMARY
from hexapods.experiments.figures.config import MAX_ROWS, FigureConfig, Kind
from hexapods.experiments.figures.files import paper_figure
from hexapods.experiments.setting_comparison import Distance, compare_settings

T = TypeVar("T")

router = api_router(prefix="/experiments/{run_id}", tags=["experiments"])

_SETTING = "a setting: its key or name, or a part that no other has"
_MEDIA_TYPES: Mapping[str, str] = {
    "zip": "application/zip",
    "pdf": "application/pdf",
    "svg": "image/svg+xml",
    "png": "image/png",
}
Setting = Annotated[str, Query(min_length=1, max_length=1000, description=_SETTING)]
DistanceQuery = Annotated[Distance, Query(description="after 50 steps of its own, or at time-out")]
UnitQuery = Annotated[
    Unit, Query(description="metres, half grid sides, or shares of greedy's distance")
]


@router.get(
    "/comparison",
    summary="Compare two settings of an experiment",
    response_model=SettingComparisonView,
)
@policy(access=WATCH_RUN, work=ANALYSIS)
def get_experiment_comparison(
    services: ServicesDep,
    run_id: RunPath,
    *,
    a: Setting,
    b: Setting,
    distance: DistanceQuery = "total",
    unit: UnitQuery = "m",
) -> Response:
    """Return the difference of two settings with its interval, by the trials so far.

    It has the probability of improvement, and how many further seeds would settle the difference.
    """
    summary = _summary(services, run_id)
    compared = _of_summary(
        run_id, lambda: compare_settings(summary, a, b, distance=distance, unit=unit)
    )
    return JSONResponse(compared.as_json())


@router.get(
    "/figure",
    summary="Draw a figure of an experiment for a paper (ZIP, PDF, SVG, PNG)",
    response_class=Response,
    responses=answers(200, dict.fromkeys(_MEDIA_TYPES.values(), BINARY), headers=ATTACHMENT),
)
@policy(access=WATCH_RUN, work=ENCODING)
def get_experiment_figure(
    services: ServicesDep,
    run_id: RunPath,
    *,
    kind: Annotated[
        Kind, Query(description="every seed, two settings and their difference, or profiles")
    ] = "seeds",
    columns: Annotated[
        Literal["1", "2"], Query(description="columns of a page: 85 or 178 mm")
    ] = "1",
    setting: Annotated[
        list[Setting] | None, Query(max_length=MAX_ROWS, description=f"{_SETTING}; by default all")
    ] = None,
    distance: DistanceQuery = "total",
    unit: UnitQuery = "m",
    format: Annotated[  # noqa: A002
        Literal["zip", "pdf", "svg", "png"], Query(description="zip has all, caption and data too")
    ] = "zip",
) -> Response:
    """Return a figure by the trials so far: the picture, or all its files in an archive.

    The archive has the figure as PDF, SVG and PNG, its caption, every seed and what is drawn of
    them as CSV, and the commands that repeat it. The server needs `racing-hexapods[figures]`.
    """
    config = FigureConfig(
        kind=kind,
        columns=1 if columns == "1" else 2,
        settings=tuple(setting or ()),
        distance=distance,
        unit=unit,
    )
    summary = _summary(services, run_id)
    content = _of_summary(run_id, lambda: paper_figure(summary, config).to_bytes(format))
    return attachment(content, _MEDIA_TYPES[format], f"{kind}-{run_id}.{format}")


def _summary(services: ServicesDep, run_id: str) -> dict[str, Any]:
    """Return the newest summary of an experiment, with the config of the run.

    Raises:
        Conflict: if it has none yet.
    """
    run = find(services, "experiment", run_id)
    stored = services.store.artifact(run.id, SUMMARY)
    if stored is None:
        raise Conflict(
            f"experiment {run.id} is {run.state}, and has no summary of trials yet", run.state
        )
    try:
        return {**json.loads(stored), "config": to_json(run.config)}
    except (ValueError, TypeError, RecursionError) as error:
        raise DamagedFile(f"{SUMMARY} of experiment {run.id} is damaged ({error})") from error


def _of_summary(run_id: str, compute: Callable[[], T]) -> T:
    """Return what is computed of a summary, which may have come with an archive.

    Raises:
        DamagedFile: if the summary lacks what it should have.
    """
    try:
        return compute()
    except HexapodError:
        raise
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise DamagedFile(f"{SUMMARY} of experiment {run_id} is damaged ({error!r})") from error
