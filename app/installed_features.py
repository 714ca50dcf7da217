"""Which features are installed, and which of them are left out: `load`."""

import importlib
from collections.abc import Collection, Mapping
from importlib.metadata import EntryPoint, entry_points
from pkgutil import iter_modules
from typing import NamedTuple

from app.feature import Feature
from app.setting_fields import PREFIX
from hexapods.domain.errors import InvalidInput

GROUP = "hexapods.features"
"""Entry-point group of features of other packages."""
_PACKAGE = "app.features"


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
    available, broken = _available()
    if needed := [failure for name, failure in broken.items() if name not in without]:
        raise needed[0]
    unknown = sorted(set(without) - available.keys() - broken.keys())
    if unknown:
        raise InvalidInput(
            f"{PREFIX}WITHOUT names no feature by {unknown[0]!r}; there are "
            f"{', '.join(sorted(available))}"
        )
    kept = {name: feature for name, feature in available.items() if name not in without}
    ordered: dict[str, type[Feature]] = {}
    for name in kept:
        _add(name, kept, available, ordered)
    left_out = (feature for name, feature in available.items() if name in without)
    return Catalogue(tuple(ordered.values()), tuple(left_out))


def _add(
    name: str,
    kept: Mapping[str, type[Feature]],
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
    for needed in kept[name].needs:
        if needed not in kept:
            where = "is left out" if needed in available else "is not installed"
            raise InvalidInput(
                f"the feature {name} needs {needed}, which {where}; leave {name} out too, by "
                f"{PREFIX}WITHOUT"
            )
        _add(needed, kept, available, ordered, waiting)
    for used in kept[name].uses:
        if used in kept:
            _add(used, kept, available, ordered, waiting)
    ordered[name] = kept[name]


def _available() -> tuple[dict[str, type[Feature]], dict[str, InvalidInput]]:
    """Return the classes of all features that are installed, by name, and why others are none."""
    package = importlib.import_module(_PACKAGE)
    modules = [f"{_PACKAGE}.{module.name}.feature" for module in iter_modules(package.__path__)]
    classes = [(name, importlib.import_module(name).FEATURE) for name in sorted(modules)]
    broken: dict[str, InvalidInput] = {}
    for entry in entry_points(group=GROUP):
        try:
            classes.append((entry.value, _loaded(entry)))
        except InvalidInput as error:
            broken[entry.name] = error
    available: dict[str, type[Feature]] = {}
    for origin, feature in classes:
        if feature.name in available:
            raise InvalidInput(
                f"two features are called {feature.name}, one of them in {origin}; uninstall one"
            )
        available[feature.name] = feature
    return available, broken


def _loaded(entry: EntryPoint) -> type[Feature]:
    remedy = (
        f"mend or uninstall its package, or leave the feature out by {PREFIX}WITHOUT={entry.name}"
    )
    try:
        feature = entry.load()
    except Exception as error:
        raise InvalidInput(
            f"the feature {entry.name} of {entry.value} cannot be imported: {error}; {remedy}"
        ) from error
    if not (isinstance(feature, type) and issubclass(feature, Feature)):
        raise InvalidInput(f"{entry.value} is no subclass of app.feature.Feature; {remedy}")
    if getattr(feature, "name", None) != entry.name:
        raise InvalidInput(
            f"the feature {entry.name} of {entry.value} must have the name of its entry point, "
            f'name = "{entry.name}"; {remedy}'
        )
    return feature
