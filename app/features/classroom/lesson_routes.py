"""Routes of lessons: documents of cards, as JSON and as YAML files."""

import json
from dataclasses import replace
from typing import Annotated, Literal

from fastapi import Depends, Path, Query, Request
from starlette.responses import Response

from app.api.answers import DeletedView
from app.api.contract import TEXT, answers
from app.api.deps import BodyDep, Services, ServicesDep
from app.api.formats import attachment, negotiated
from app.api.policy import OPERATOR, api_router, policy
from app.api.record_response import RecordResponse
from app.api.spectators import link_to
from app.features.classroom.access import LESSONS, ReaderDep
from app.features.classroom.card_starts import CardStarts
from app.features.classroom.lesson import GIVEN_LESSON, Lesson, html_of
from app.features.classroom.lesson_file import (
    MAX_BYTES,
    MEDIA_TYPE,
    read_file,
    read_plain_values,
    write_file,
)
from app.features.classroom.lessons import ENGLISH, FoundLesson, Lessons, in_all_languages
from app.features.classroom.response_models import LessonList, LessonView, ListedLesson, NewLesson
from app.features.classroom.rooms import Rooms
from hexapods.domain.errors import InvalidInput

YAML_TYPES = (MEDIA_TYPE, "text/yaml", "application/x-yaml", "text/x-yaml")
_TYPES = {"application/json": "json", **dict.fromkeys(YAML_TYPES, "yaml")}
LanguageQuery = Annotated[
    str,
    Query(max_length=40, description="language of built-in lessons, such as `de`; others have one"),
]
LessonPath = Annotated[str, Path(description="id of the lesson", max_length=100)]

router = api_router(prefix="/lessons", tags=["lessons"])


def _lesson(services: ServicesDep, request: Request, body: BodyDep) -> Lesson:
    """Return the lesson of a request's body, in JSON or YAML by its media type."""
    services.store.check_disk_space(len(body))
    media_type = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if len(body) > MAX_BYTES:
        raise InvalidInput(f"a lesson has at most {MAX_BYTES // 1024} kB")
    if media_type in YAML_TYPES:
        return read_file(body, "the lesson")
    try:
        data = json.loads(body)
    except (ValueError, RecursionError) as error:
        raise InvalidInput(
            f"the body is no JSON; send a lesson as application/json, or as {MEDIA_TYPE}"
        ) from error
    return read_plain_values(data)


@router.post(
    "",
    status_code=201,
    summary="Store a lesson",
    responses=answers(201, headers={"Location": {"required": True, "schema": TEXT}}),
    openapi_extra={
        "requestBody": {
            "content": {
                "application/json": {"schema": GIVEN_LESSON},
                MEDIA_TYPE: {"schema": GIVEN_LESSON},
            },
            "required": True,
        }
    },
)
@policy(access=OPERATOR)
def add_lesson(
    services: ServicesDep, request: Request, lesson: Annotated[Lesson, Depends(_lesson)]
) -> RecordResponse[NewLesson]:
    """Store the lesson; the same content has the same id, on every server.

    The runs of its cards must be possible to start; the bounds of settings that they open must be
    within the settings' own. Texts are Markdown without HTML, pictures and scripts.
    """
    services.of(CardStarts).check(lesson, services.store)
    stored = services.of(Lessons).add(lesson)
    path = request.url_for("get_lesson", lesson_id=stored.id).path
    link = link_to(request, services.settings, f"/l/{stored.id}")
    lesson_added = NewLesson(id=stored.id, link=link.address, qr_code=link.qr_code)
    return RecordResponse(lesson_added, 201, {"Location": path})


@router.get("", summary="List lessons")
@policy(access=LESSONS)
def list_lessons(
    services: ServicesDep, language: LanguageQuery = ENGLISH
) -> RecordResponse[LessonList]:
    """Return the lessons that are built in, and those that were stored."""
    items = [
        ListedLesson(
            id=stored.id,
            title=stored.lesson.title,
            language=stored.lesson.language,
            minutes=stored.lesson.minutes,
            ages=stored.lesson.ages,
            aims=list(stored.lesson.aims),
            has_knowledge_question=stored.lesson.before is not None,
            cards=len(stored.lesson.cards),
            is_built_in=stored.is_built_in,
        )
        for stored in services.of(Lessons).all(language)
    ]
    return RecordResponse(LessonList(items=items))


@router.get(
    "/{lesson_id}",
    summary="Get a lesson (JSON, YAML)",
    responses=answers(200, {MEDIA_TYPE: GIVEN_LESSON}),
)
@policy(access=LESSONS, depends_on_state=False)
def get_lesson(
    services: ServicesDep,
    request: Request,
    lesson_id: LessonPath,
    reader: ReaderDep,
    *,
    format: Annotated[Literal["json", "yaml"] | None, Query()] = None,  # noqa: A002
    language: LanguageQuery = ENGLISH,
) -> RecordResponse[LessonView] | Response:
    """Return a lesson; as YAML it is the file that `POST /lessons` takes, on any server.

    While an open room teaches the lesson, operators alone get all of it: for others it has neither
    the revealed parts nor the cards after the one that the room shows.
    """
    stored, is_taught = services.of(Lessons).get(lesson_id, language), False
    if reader is not None:
        stored, is_taught = _while_taught(services, stored)
    if negotiated(request, format, ("json", "yaml"), _TYPES) == "yaml":
        text = write_file(stored.lesson).encode()
        return attachment(text, MEDIA_TYPE, f"lesson-{stored.id}.yaml")
    return RecordResponse(lesson_view(stored, is_taught=is_taught))


def _while_taught(services: Services, stored: FoundLesson) -> tuple[FoundLesson, bool]:
    """Return the part of a lesson that all may read, and whether an open room teaches it."""
    rooms = services.of(Rooms)
    taught = (rooms.taught(lesson) for lesson in in_all_languages(stored))
    shown = min((card for card in taught if card is not None), default=None)
    if shown is None:
        return stored, False
    lesson = stored.lesson
    around = 0 if lesson.before is None else 1
    cards = tuple(replace(card, reveal=None) for card in lesson.cards[: max(1, shown + 1 - around)])
    return replace(stored, lesson=replace(lesson, cards=cards, before=None, after=None)), True


@router.delete("/{lesson_id}", summary="Delete a stored lesson")
@policy(access=OPERATOR)
def delete_lesson(services: ServicesDep, lesson_id: LessonPath) -> RecordResponse[DeletedView]:
    """Delete a stored lesson; rooms that teach it keep their copy.

    It can be restored for an hour, unless the disk is full.
    """
    until = services.of(Lessons).delete(lesson_id)
    return RecordResponse(DeletedView(deleted=[lesson_id], kept=[], restorable_until=until))


@router.post("/{lesson_id}/restore", summary="Restore a stored lesson that was deleted")
@policy(access=OPERATOR)
def restore_lesson(services: ServicesDep, lesson_id: LessonPath) -> RecordResponse[LessonView]:
    """Bring back a lesson that was deleted within the last hour; one that is there stays."""
    return RecordResponse(lesson_view(services.of(Lessons).restore(lesson_id)))


def lesson_view(stored: FoundLesson, *, is_taught: bool = False) -> LessonView:
    """Return a lesson as `GET /lessons/{lesson_id}` responds; `is_taught` if parts are left out."""
    lesson = stored.lesson
    return LessonView(
        title=lesson.title,
        language=lesson.language,
        minutes=lesson.minutes,
        ages=lesson.ages,
        aims=lesson.aims,
        before=lesson.before,
        after=lesson.after,
        cards=lesson.cards,
        id=stored.id,
        is_built_in=stored.is_built_in,
        is_taught=is_taught,
        html=tuple(map(html_of, lesson.cards)),
    )
