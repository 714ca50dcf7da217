"""Defaults of all settings of a server and its features, for tests that look for each of them."""

from dataclasses import fields
from itertools import chain
from typing import Any

from app.feature_settings import installed_settings
from app.settings import Settings

DEFAULTS: dict[str, Any] = {
    setting.name: setting.default
    for setting in (*fields(Settings), *chain(*map(fields, installed_settings())))
    if setting.name != "features"
}
"""By name; a marker of `dataclasses` for the folder of the data, which has no default."""
