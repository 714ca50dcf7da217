"""Which features are installed, and which of them are left out: `load`."""

from collections.abc import Collection, Mapping
from importlib.metadata import entry_points
from typing import Any, NamedTuple

from app.feature import Feature
from app.feature_modules import broken_part, feature_modules
from app.setting_fields import PREFIX
from hexapods.domain.errors import InvalidInput

GROUP = "hexapods.features"
"""Entry-point group of features of other packages."""


class Catalogue(NamedTuple):
    """The classes of all features that are installed.

    Attributes:
        classes: each after those that it needs.
        left_out: of those that are left out.
    """

    classes: tuple[type[Feature], ...]
    left_out: tuple[type[Feature], ...] = ()


def load(without: Collection[str] = ()) -> Catalogue:
    """Return the classes of all features, of which some are left out.

    Args:
        without: names of those to leave out.

    Raises:
        InvalidInput: if there is no feature of such a name, one needs another that is left out, or
            two have the same name.
    """
    available = _available(without)
    broken = {entry.name for entry in entry_points(group=GROUP)} - available.keys()
    unknown = sorted(set(without) - available.keys() - broken)
    if unknown:
        raise InvalidInput(
            f"{PREFIX}WITHOUT names no feature by {unknown[0]!r}; there are "
            f"{', '.join(sorted(available))}"
        )
    included = {name: feature for name, feature in available.items() if name not in without}
    ordered: dict[str, type[Feature]] = {}
    for name in included:
        _add(name, included, available, ordered)
    left_out = (feature for name, feature in available.items() if name in without)
    return Catalogue(tuple(ordered.values()), tuple(left_out))


def _add(
    name: str,
    included: Mapping[str, type[Feature]],
    available: Mapping[str, type[Feature]],
    ordered: dict[str, type[Feature]],
    waiting: tuple[str, ...] = (),
) -> None:
    """Add a feature to those that are ordered, after those that it needs and uses.

    Of features that need each other, whose names are in `waiting`, one is first.
    """
    if name in (*ordered, *waiting):
        return
    waiting += (name,)
    for needed in included[name].needs:
        if needed not in included:
            where = "is left out" if needed in available else "is not installed"
            raise InvalidInput(
                f"the feature {name} needs {needed}, which {where}; leave {name} out too, by "
                f"{PREFIX}WITHOUT"
            )
        _add(needed, included, available, ordered, waiting)
    for used in included[name].uses:
        if used in included:
            _add(used, included, available, ordered, waiting)
    ordered[name] = included[name]


def _available(without: Collection[str]) -> dict[str, type[Feature]]:
    """Return the classes of all features that are installed, by name."""
    available: dict[str, type[Feature]] = {}
    for name, origin, module in feature_modules("feature", GROUP, without):
        feature = _checked(name, getattr(module, "FEATURE", module))
        if name in available:
            raise InvalidInput(
                f"two features are called {name}, one of them in {origin}; uninstall one"
            )
        available[name] = feature
    return available


def _checked(name: str, feature: Any) -> type[Feature]:
    if not (isinstance(feature, type) and issubclass(feature, Feature)):
        raise broken_part(name, "feature", "is no subclass of app.feature.Feature")
    if getattr(feature, "name", None) != name:
        raise broken_part(name, "feature", f'needs the name of its entry point, name = "{name}"')
    return feature
