"""Routes of experiments: summary, trials, report and its files."""

import json
from typing import Annotated, Any, Literal

from fastapi import Path, Query, Request
from starlette.responses import JSONResponse, Response

from app.api.contract import ATTACHMENT, LOCATION, TEXT, answers
from app.api.deps import ServicesDep, StartRequestDep
from app.api.formats import attachment, file_response, negotiated
from app.api.policy import OPERATOR, WATCH_RUN, policy
from app.api.runs import RunPath, find, run_routes, start_run
from app.api.work import ANALYSIS, DOWNLOAD
from app.events.run_view import RaceView, TrainingView
from app.features.experiments.request_bodies import TrialBody
from app.features.experiments.response_models import (
    ExperimentPage,
    ExperimentView,
    SummaryView,
    TrialsView,
)
from app.features.experiments.stored_trials import trials_as_csv
from app.features.experiments.trial_rows import Trials
from app.features.experiments.trial_runs import trial_start
from app.storage.artifact_file import ArtifactFile
from app.storage.errors import Conflict, NotFound
from app.storage.json_text import finite
from app.storage.run import NOT_ENDED, Run
from hexapods.domain.records import to_json
from hexapods.experiments.config import SUMMARY, SUMMARY_FORMAT, ExperimentConfig
from hexapods.experiments.report.page import page
from hexapods.experiments.result import ExperimentResult

REPORT_POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'self'; sandbox allow-popups"
)
"""Content security policy of stored files: a forged report can run no scripts."""
_PAGE_POLICY = "sandbox allow-scripts allow-popups allow-downloads; frame-ancestors 'self'"
"""Policy of a report that is made here, in addition to its own; it has no origin."""
_MEDIA_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".json": "application/json",
    ".csv": "text/csv; charset=utf-8",
}
_FILE_SCHEMAS: dict[str, dict[str, Any]] = {
    "text/html": TEXT,
    "application/json": {"$ref": "#/components/schemas/SummaryView"},
    "text/csv": TEXT,
}

router = run_routes("experiment", ExperimentView, ExperimentPage, changed_by=OPERATOR)


@router.get("/{run_id}/summary", summary="Get an experiment's summary", response_model=SummaryView)
@policy(access=WATCH_RUN, work=ANALYSIS)
def get_experiment_summary(services: ServicesDep, run_id: RunPath) -> Response:
    """Return the newest summary, which is recomputed every few seconds while trials run."""
    run = find(services, "experiment", run_id)
    summary = services.store.open_artifact(run_id, SUMMARY)
    if summary is None:
        return JSONResponse(_empty_summary(run))
    return file_response(summary, "application/json")


@router.get(
    "/{run_id}/report",
    summary="Get an experiment's report (one HTML file)",
    response_class=Response,
    responses=answers(200, {"text/html": TEXT}, headers=ATTACHMENT),
)
@policy(access=WATCH_RUN, work=ANALYSIS)
def get_experiment_report(services: ServicesDep, run_id: RunPath) -> Response:
    """Return the whole report as one file, once the experiment has ended."""
    run = find(services, "experiment", run_id)
    _open_report_file(services, run, SUMMARY).close()
    summary = json.loads(services.store.artifact(run.id, SUMMARY) or b"{}")
    # Made anew: a stored one may be forged, and runs scripts.
    content = page({**summary, "config": to_json(run.config)})
    headers = {
        "Content-Disposition": f'inline; filename="report-{run.id}.html"',
        "Content-Security-Policy": _PAGE_POLICY,
    }
    return Response(content, media_type="text/html; charset=utf-8", headers=headers)


@router.get(
    "/{run_id}/files/{name:path}",
    summary="Get a file of an experiment's report",
    response_class=Response,
    responses=answers(200, _FILE_SCHEMAS, headers=ATTACHMENT),
)
@policy(access=WATCH_RUN, work=DOWNLOAD)
def get_experiment_file(
    services: ServicesDep, run_id: RunPath, name: Annotated[str, Path(description="file name")]
) -> Response:
    """Return one of the report's files, which the run's `result` lists in `files`."""
    run = find(services, "experiment", run_id)
    return _report_response(run, name, _open_report_file(services, run, name), "attachment")


@router.get(
    "/{run_id}/trials",
    summary="List an experiment's trials (JSON, CSV)",
    response_model=TrialsView,
    responses=answers(200, {"text/csv": TEXT}),
)
@policy(access=WATCH_RUN, work=ANALYSIS)
def get_experiment_trials(
    services: ServicesDep,
    request: Request,
    run_id: RunPath,
    format: Annotated[Literal["json", "csv"] | None, Query()] = None,  # noqa: A002
) -> Response:
    """Return the trials so far, by key: the setting and the seed's number."""
    config = _config(find(services, "experiment", run_id))
    rows = Trials(services.store.database).get(run_id)
    if negotiated(request, format, ("json", "csv")) == "csv":
        table = trials_as_csv(config, rows)
        return attachment(table, "text/csv; charset=utf-8", f"trials-{run_id}.csv")
    return JSONResponse(finite({"trials": list(rows)}))


@router.post(
    "/{run_id}/trials/run",
    status_code=202,
    summary="Run one trial of an experiment again",
    response_model=TrainingView | RaceView,
    responses=answers(202, headers=LOCATION),
)
@policy(access=OPERATOR, starts=True)
def run_trial(
    services: ServicesDep,
    request: Request,
    run_id: RunPath,
    start_request: StartRequestDep,
    body: TrialBody,
) -> Response:
    """Queue a run with the config and the seed of a trial, and so with its outcome.

    It is a race of one lane after its practice; of a league or recovery, the practice.
    """
    config = _config(find(services, "experiment", run_id))
    start = trial_start(config, run_id, body.key)
    return start_run(services, request, start_request, start)


def _config(run: Run) -> ExperimentConfig:
    if not isinstance(run.config, ExperimentConfig):
        raise NotFound(f"{run.id} is no experiment")
    return run.config


def _empty_summary(run: Run) -> dict[str, Any]:
    """Return the summary of zero trials, for an experiment that has none yet."""
    lists = (
        "parameters",
        "settings",
        "pooled",
        "curves",
        "versus",
        "timed",
        "worlds",
        "claims",
        "story",
    )
    config = _config(run)
    return {
        "format": SUMMARY_FORMAT,
        "experiment": config.experiment,
        "config": to_json(config),
        "versions": {},
        "machine": {},
        "trials": {"done": 0, "total": run.total, "failed": 0, "set_aside": []},
        "cost": None,
        **{name: [] for name in lists},
        "finding": "",
    }


def _open_report_file(services: ServicesDep, run: Run, name: str) -> ArtifactFile:
    if run.state in NOT_ENDED or run.state == "interrupted":
        raise Conflict(
            f"experiment {run.id} is {run.state}; its report can be had once it is finished or "
            "stopped",
            run.state,
        )
    files = run.result.files if isinstance(run.result, ExperimentResult) else ()
    file = services.store.open_artifact(run.id, name) if name in files else None
    if file is None:
        valid_names = ", ".join(files) or "none"
        raise NotFound(f"experiment {run.id} has no such file; there are: {valid_names}")
    return file


def _report_response(run: Run, name: str, file: ArtifactFile, disposition: str) -> Response:
    last = name.rpartition("/")[2]
    stem, dot, suffix = last.rpartition(".")
    headers = {
        "Content-Disposition": f'{disposition}; filename="{stem}-{run.id}{dot}{suffix}"',
        "Content-Security-Policy": REPORT_POLICY,
    }
    return file_response(file, _MEDIA_TYPES.get(f"{dot}{suffix}"), headers)
