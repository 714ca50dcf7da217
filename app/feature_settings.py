"""Settings of features: how a feature declares its HEXAPODS_… variables, and where they are.

A feature declares them in a module `app/features/NAME/settings.py`, and another package in a module
of its own, which an entry point of the group `hexapods.settings` gives with the feature's name:
`SETTINGS` is a subclass of `FeatureSettings`. Neither imports a server, since each command that
reads settings would wait for it. The feature asks for its values by
`core.settings.of(ItsSettings)`.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar

from app.feature_modules import broken_part, feature_modules
from app.setting_fields import PREFIX, Switch, check_kinds, kind_of, variable_of
from hexapods.domain.errors import InvalidInput

if TYPE_CHECKING:
    from app.settings import Settings

GROUP = "hexapods.settings"
"""Entry-point group of settings of features of other packages."""


@dataclass(frozen=True, kw_only=True)
class FeatureSettings:
    """Base class of the settings of a feature: a frozen dataclass whose fields have defaults.

    `app.setting_fields` declares fields with a kind, which says how the text of the variable is
    read and which values there are; a field without a kind has the text as it is.

    Attributes:
        feature: name of the feature.
        left_out: what it means, for the error, if a switch is on and HEXAPODS_WITHOUT leaves the
            feature out, such as `so that nothing is deleted`.
    """

    feature: ClassVar[str]
    left_out: ClassVar[str] = ""

    def __post_init__(self) -> None:
        check_kinds(self)

    @property
    def needs_token(self) -> bool:
        """Whether a server needs a token by these even on loopback; `hexapods serve` makes one."""
        return False

    @property
    def audience(self) -> str | None:
        """Title of a shared link, such as `Readers (may write)`; None if it is for spectators."""
        return None

    def stricter_defaults(self) -> Mapping[str, Any]:
        """Return defaults, by name, of settings of the core and of other features."""
        return {}

    def check(self, settings: "Settings") -> None:
        """Check these beside all other settings of a server; InvalidInput for what cannot be."""

    def check_left_out(self) -> None:
        """Raise InvalidInput if something is switched on of a feature that is left out."""
        for declared in fields(self):
            if isinstance(kind_of(declared), Switch) and getattr(self, declared.name):
                consequence = f", {self.left_out}" if self.left_out else ""
                raise InvalidInput(
                    f"{variable_of(declared.name)} is on, and {PREFIX}WITHOUT leaves the "
                    f"{self.feature} out{consequence}; take one of both back"
                )


def installed_settings(without: Collection[str] = ()) -> Iterator[type[FeatureSettings]]:
    """Yield the classes of the settings of all features, also of those that are left out.

    Args:
        without: names of features that are left out, of which errors are ignored.

    Raises:
        InvalidInput: if the settings of a feature of another package cannot be imported.
    """
    for feature, _, module in feature_modules("settings", GROUP, without):
        settings = getattr(module, "SETTINGS", None)
        if (
            isinstance(settings, type)
            and issubclass(settings, FeatureSettings)
            and settings.feature == feature
        ):
            yield settings
        elif feature not in without:
            raise broken_part(
                feature,
                "settings",
                f"needs SETTINGS, a subclass of FeatureSettings with feature = {feature!r}",
            )
