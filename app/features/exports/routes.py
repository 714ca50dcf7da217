"""Routes of a run's walk as files for other programs, one for each format of the registry."""

from collections.abc import Callable
from inspect import Parameter, Signature
from typing import Annotated, Any, Literal, NamedTuple

from fastapi import Depends, Query, Request
from starlette.responses import Response

from app.api.contract import ATTACHMENT, BINARY, TEXT, answers
from app.api.deps import ServicesDep
from app.api.fields import Declared
from app.api.formats import attachment, negotiated
from app.api.policy import OPERATOR, WATCH_RUN, RoutePolicy, api_router, with_policy
from app.api.runs import RunPath
from app.api.work import DOWNLOAD, ENCODING
from app.features.exports.file_renderer import FileRenderer
from app.features.exports.stored_walks import source_of
from app.storage.errors import Conflict
from hexapods.domain.errors import TooLong
from hexapods.exports.export_format import Execution, ExportFormat, FileType, Load
from hexapods.exports.options import ExportOptions
from hexapods.exports.registry import EXPORTS

router = api_router(prefix="/runs/{run_id}", tags=["exports"])


class _Query(NamedTuple):
    file: FileType
    options: ExportOptions


def _query_of(export_format: ExportFormat) -> Callable[..., _Query]:
    """Return a dependency whose query parameters are a format's options, and its types of file."""

    def read(request: Request, **query: Any) -> _Query:
        types = {file.media_type.partition(";")[0]: file.ending for file in export_format.files}
        ending = negotiated(request, query.pop("format", None), export_format.endings, types)
        return _Query(export_format.file(ending), export_format.options(**query))

    parameters = [Parameter("request", Parameter.KEYWORD_ONLY, annotation=Request)]
    annotations: dict[str, tuple[Any, Any]] = {}
    if len(export_format.files) > 1:
        annotations["format"] = (Annotated[Literal[export_format.endings] | None, Query()], None)
    for name, setting in export_format.settings.items():
        query = Query(description=f"{setting.about.title}. {setting.about.help}")
        annotations[name] = (
            Annotated[Any, Declared(setting, is_text=True), query],
            setting.default,
        )
    for name, (annotation, default) in annotations.items():
        parameters.append(
            Parameter(name, Parameter.KEYWORD_ONLY, annotation=annotation, default=default)
        )
    read.__signature__ = Signature(parameters)  # type: ignore[attr-defined]
    return read


_POLICIES: dict[Load, RoutePolicy] = {
    "stream": RoutePolicy(access=WATCH_RUN, work=DOWNLOAD),
    "encode": RoutePolicy(access=WATCH_RUN, work=ENCODING),
    # The renderer has slots of its own.
    "render": RoutePolicy(access=OPERATOR, starts=True),
}
"""By what a format costs a server."""


def _endpoint(export_format: ExportFormat) -> Callable[..., Response]:
    @with_policy(_POLICIES[export_format.load])
    def export(
        services: ServicesDep,
        run_id: RunPath,
        query: Annotated[_Query, Depends(_query_of(export_format))],
    ) -> Response:
        run = services.store.find(run_id)
        source = source_of(run, services.recordings, services.replays.encoded)
        execution = Execution(
            export_format.max_served_frames,
            services.stopping.check,
            services.of(FileRenderer).render,
        )
        try:
            chunks = export_format.write(source, query.file, query.options, execution)
        except TooLong as error:
            raise Conflict(str(error), "finished") from error
        return attachment(chunks, query.file.media_type, f"{run.kind}-{run.id}.{query.file.ending}")

    return export


def _description(export_format: ExportFormat) -> str:
    sentences = [export_format.note]
    for extra in dict.fromkeys(
        file.extra for file in export_format.files if file.extra is not None
    ):
        endings = " and ".join(
            f"`.{file.ending}`" for file in export_format.files if file.extra == extra
        )
        sentences.append(f"For {endings} the server needs `racing-hexapods[{extra}]`.")
    if export_format.max_served_frames is not None:
        sentences.append(f"At most {export_format.max_served_frames:,} frames.")
    if export_format.load == "render":
        sentences.append("One at a time.")
    return f"{' '.join(sentences)}\n\n`docs/exports.md` describes it."


for _name, _format in EXPORTS.items():
    _types = {file.media_type.partition(";")[0] for file in _format.files}
    router.add_api_route(
        f"/{_name}",
        _endpoint(_format),
        methods=[_format.method],
        name=f"{'render' if _format.load == 'render' else 'get'}_run_{_name}",
        summary=f"Export {_format.title} ({', '.join(f'.{ending}' for ending in _format.endings)})",
        description=_description(_format),
        response_class=Response,
        responses=answers(
            200,
            {kind: TEXT if kind.startswith("text/") else BINARY for kind in sorted(_types)},
            headers=ATTACHMENT,
        ),
    )
