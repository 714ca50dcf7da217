"""The setting of what-ifs."""

from dataclasses import dataclass
from typing import ClassVar

from app.feature_settings import FeatureSettings
from app.setting_fields import whole_number


@dataclass(frozen=True, kw_only=True)
class WhatIfSettings(FeatureSettings):
    """Settings of what-ifs.

    Attributes:
        what_ifs_per_minute: how many what-ifs the spectators of one address may ask; operators may
            ask any number.
    """

    feature: ClassVar[str] = "what_if"

    what_ifs_per_minute: int = whole_number(30, 1)


SETTINGS = WhatIfSettings
