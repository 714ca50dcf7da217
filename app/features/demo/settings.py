"""Settings of a demo, and what they mean for those of the whole server."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from app.feature_settings import FeatureSettings
from app.setting_fields import PREFIX, switch, whole_number
from app.settings import Settings
from hexapods.domain.errors import InvalidInput

_STRICTER_DEFAULTS: Mapping[str, Any] = {
    "starts_per_minute": 120,
    "what_ifs_per_minute": 20,
    "max_viewers": 200,
    "quota_mb": 4000,
}
"""Stricter defaults of settings on a demo, which strangers use; a class may share an address."""


@dataclass(frozen=True, kw_only=True)
class DemoSettings(FeatureSettings):
    """Settings of a demo.

    Attributes:
        demo: whether strangers may train, within an allowance, what is deleted after a day.
        demo_steps_per_hour: how many steps a visitor of a demo may compute in an hour.
        demo_hours: after how many hours what a visitor of a demo has made is deleted.
    """

    feature: ClassVar[str] = "demo"
    left_out: ClassVar[str] = "so that nothing that strangers make would be deleted"

    demo: bool = switch(
        option="let strangers train within an allowance, and delete what they make after a day "
        "(or HEXAPODS_DEMO=1); print the links, with a token that is made if none is set, on "
        "loopback alone"
    )
    demo_steps_per_hour: int = whole_number(20_000, 1, unit=" of steps")
    demo_hours: int = whole_number(24, 1, 24, unit=" of hours")

    @property
    def needs_token(self) -> bool:
        return self.demo

    @property
    def audience(self) -> str | None:
        return "Visitors (may train, a day)" if self.demo else None

    def stricter_defaults(self) -> Mapping[str, Any]:
        return _STRICTER_DEFAULTS if self.demo else {}

    def check(self, settings: Settings) -> None:
        if not self.demo:
            return
        if settings.token is None:
            raise InvalidInput(
                f"a demo needs {PREFIX}TOKEN, or every stranger would be its operator; "
                "`openssl rand -hex 16` makes a good one"
            )
        if settings.spectators != "public":
            raise InvalidInput(
                f"a demo is open to strangers: leave {PREFIX}SPECTATORS out, or leave out "
                f"{PREFIX}DEMO"
            )


SETTINGS = DemoSettings
