"""Response models of estimates, and of the defaults of a what-if, as those of `app.api.answers`."""

from typing import Annotated

from pydantic import Field

from app.answer import Answer


class EstimateView(Answer):
    """Estimated duration of a run here once it has a core [s].

    Attributes:
        workers: how many of its practices are computed at once; null where there are few.
    """

    seconds: Annotated[float, Field(ge=0)]
    workers: Annotated[int, Field(ge=1)] | None


class WhatIfDefaults(Answer):
    """The number of seeds of a what-if."""

    seeds: int
