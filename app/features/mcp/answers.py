"""Answers of the tools; their fields are in the schemas that the protocol shows."""

from typing import Annotated, Any

from pydantic import BaseModel, Field


class RunSummary(BaseModel):
    """A run in a few words."""

    id: str
    kind: str
    name: str | None
    state: Annotated[str, Field(description="queued, running, paused, or how it has ended")]
    done: int
    total: Annotated[int, Field(description="steps, or what runs of its kind count")]
    distance_m: Annotated[
        float | None,
        Field(description="of a training in 50 steps, of a race the winner's at time-out [m]"),
    ] = None
    winner: Annotated[str | None, Field(description="of a race: the agent of the first lane")] = (
        None
    )
    error: str | None = None

    @classmethod
    def of(cls, view: dict[str, Any]) -> "RunSummary":
        """Return the summary of a run as the REST API shows it."""
        if "damaged" in view:
            state, error = "damaged", view["damaged"]
            return cls(**_named(view), state=state, done=0, total=0, error=error)
        distance_m, winner, result = None, None, view["result"] or {}
        if view["kind"] == "training":
            distance_m = result.get("distance_m")
        elif view["kind"] == "race":
            for lane in result.get("lanes", ()):
                if lane["clocks"]["paper"]["rank"] == 1:
                    winner = lane["agent"]
                    distance_m = lane["clocks"]["paper"]["finished_distance_m"]
        return cls(
            **_named(view),
            **view["progress"],
            state=view["state"],
            distance_m=distance_m,
            winner=winner,
            error=view["error"],
        )


def _named(view: dict[str, Any]) -> dict[str, Any]:
    return {"id": view["id"], "kind": view["kind"] or "run", "name": view["name"]}


class RunList(BaseModel):
    """A page of runs, the newest first."""

    runs: list[RunSummary]
    next_cursor: Annotated[str | None, Field(description="`cursor` of the next page; null at last")]


class ExplainedStep(BaseModel):
    """Why a robot made a step, as the page says under *Why*."""

    run_id: str
    lane: int | None
    step: int
    agent: str
    reward_m: Annotated[float, Field(description="what the step brought [m]")]
    what: str
    why: Annotated[str | None, Field(description="null where the choice is not explained")]
    missed: str | None
    rule: Annotated[
        str | None, Field(description="update of its value with numbers put in; null without one")
    ]
    unexplained: Annotated[str | None, Field(description="why the choice is not explained")]


class Difference(BaseModel):
    """Two groups of seeds compared: the difference a − b with its 95 % interval."""

    a: str
    b: str
    seeds_a: int
    seeds_b: int
    unit: str
    difference: float
    low: Annotated[float | None, Field(description="null where there are too few seeds")]
    high: float | None
    ahead: Annotated[str, Field(description="a, b, or not established")]
    is_paired: Annotated[bool, Field(description="whether equal seeds were compared")]
    further_seeds: Annotated[
        int | None, Field(description="of each, that would settle it; null where none would")
    ]
    words: str

    @classmethod
    def of(cls, compared: dict[str, Any]) -> "Difference":
        """Return a comparison as the REST API and `Comparison.as_json` have it."""
        difference = compared["difference"]
        return cls(
            a=compared["a"]["name"],
            b=compared["b"]["name"],
            seeds_a=compared["a"]["seeds"],
            seeds_b=compared["b"]["seeds"],
            unit=compared["unit"],
            difference=difference["value"],
            low=difference["low"],
            high=difference["high"],
            ahead=compared["ahead"],
            is_paired=compared["is_paired"],
            further_seeds=compared["further_seeds"],
            words=" ".join(filter(None, compared["words"].values())),
        )


class Started(BaseModel):
    """A run that was started, and what is left of the allowance."""

    run: RunSummary
    starts_left: int
    steps_left: int
