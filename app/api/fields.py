"""Fields that requests have in common, and what every request's object is."""

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from app.api.sentences import VALID
from app.domain.errors import InvalidInput, UnknownName
from app.domain.grid import MAX_DIVISIONS, MIN_DIVISIONS, MIN_SIDE_M
from app.runs.config import MAX_STEPS
from app.services.text import MAX_NAME, check_name


def _name(text: str) -> str:
    try:
        return check_name(text)
    except InvalidInput as error:
        raise ValueError(str(error)) from error


def number(**limits: Any) -> Any:
    """A number that JSON has, within limits."""
    return Field(strict=True, allow_inf_nan=False, **limits)


Name = Annotated[
    str,
    Field(max_length=MAX_NAME, description=VALID["name"]),
    AfterValidator(_name),
]
RunId = Annotated[str, Field(min_length=1, max_length=64)]
Steps = Annotated[int, Field(strict=True, ge=1, le=MAX_STEPS, description=VALID["steps"])]
Seed = Annotated[int, Field(strict=True, ge=0, description=VALID["seed"])]
Alpha = Annotated[float, number(gt=0, le=1, description=VALID["alpha"])]
Gamma = Annotated[float, number(ge=0, lt=1, description=VALID["gamma"])]
Epsilon = Annotated[float, number(ge=0, le=1, description=VALID["epsilon"])]
Divisions = Annotated[int, Field(strict=True, ge=MIN_DIVISIONS, le=MAX_DIVISIONS)]
Side = Annotated[float, number(ge=MIN_SIDE_M)]
Pace = Literal["max"] | Annotated[float, number(ge=0.01, le=1000)]


class Body(BaseModel):
    """A JSON object without a field that nobody knows."""

    model_config = ConfigDict(extra="forbid")

    @model_validator(mode="before")
    @classmethod
    def _know_all_fields(cls, value: Any) -> Any:
        unknown = [n for n in value if n not in cls.model_fields] if isinstance(value, dict) else []
        if unknown:
            message = str(UnknownName("field", unknown[0][:MAX_NAME], cls.model_fields))
            # As a value and not as a template: a name may have braces in it.
            raise PydanticCustomError("unknown_field", "{message}", {"message": message})
        return value
