"""Page state of a card: a part of its state document (`static/js/page-state.js`)."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from annotated_types import Ge, Le, MaxLen
from pydantic import JsonValue

from hexapods.domain.records import Record
from hexapods.runs.clocks import Clock
from hexapods.runs.race_config import MAX_ID

Depth = Literal["watch", "try", "study"]
Tab = Literal["board", "train", "world", "why", "gait", "table", "what-if"]
RunId = Annotated[str, MaxLen(MAX_ID)]
MAX_MOMENT_S = 1e6
MAX_FORM_FIELDS = 60


@dataclass(frozen=True, kw_only=True)
class PageState(Record):
    """A part of the page's state document; what is null stays as it is.

    Attributes:
        view: the open view.
        form: fields of the start that the page offers, by name: those of a training, settings of
            its agent (by themselves or in `settings`), `lanes` and `race_steps` of a race, `world`
            and `disturb`.
        run: id of the run that is replayed.
        ghost: id of the run whose robots walk along.
        moment: where the replay is held [s].
        clock: of the replay of a race.
        end: where the replay of a race ends.
        depth: how much of the page is shown.
        tab: the open tab of the panel.
        pinned: a second tab beside it.
        camera: its target: `directed` (or `leader`, the same), `free`, or the number of a lane.
        hidden: parts of the page that are hidden.
    """

    view: Literal["race", "experiments", "runs", "compare"] | None = None
    form: Annotated[Mapping[str, JsonValue], MaxLen(MAX_FORM_FIELDS)] | None = None
    run: RunId | None = None
    ghost: RunId | None = None
    moment: Annotated[float, Ge(0), Le(MAX_MOMENT_S)] | None = None
    clock: Clock | None = None
    end: Literal["time-out", "all"] | None = None
    depth: Depth | None = None
    tab: Tab | None = None
    pinned: Tab | None = None
    camera: Literal["directed", "leader", "free", "1", "2", "3", "4", "5", "6", "7", "8"] | None = (
        None
    )
    hidden: Annotated[tuple[Literal["panel", "card"], ...], MaxLen(2)] = ()


Form = Mapping[str, Any]
