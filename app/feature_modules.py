"""Parts of features in modules of their own, which the core finds without importing the rest.

A feature `app/features/NAME` has a part in a module there, such as `commands`. A feature of another
package names its module, or class, by an entry point with the feature's name in the part's group.
"""

import importlib
import pkgutil
from collections.abc import Collection, Iterator
from importlib.metadata import entry_points
from importlib.util import find_spec
from typing import Any, NamedTuple

from app.setting_fields import PREFIX
from hexapods.domain.errors import InvalidInput

_PACKAGE = "app.features"


class FeatureModule(NamedTuple):
    """A part of a feature.

    Attributes:
        feature: name of the feature.
        origin: where the part is.
        part: the module; of another package what its entry point names.
    """

    feature: str
    origin: str
    part: Any


def feature_modules(
    name: str, group: str, without: Collection[str] = ()
) -> Iterator[FeatureModule]:
    """Yield a part of each feature that has it, also of features that are left out.

    Args:
        name: of the module in the feature's folder.
        group: of the entry points of other packages.
        without: names of features that are left out, of which one may be broken.

    Raises:
        InvalidInput: if the part of a feature of another package cannot be imported.
    """
    package = importlib.import_module(_PACKAGE)
    for feature in sorted(module.name for module in pkgutil.iter_modules(package.__path__)):
        path = f"{_PACKAGE}.{feature}.{name}"
        if find_spec(path) is not None:
            yield FeatureModule(feature, path, importlib.import_module(path))
    for entry in entry_points(group=group):
        try:
            module = entry.load()
        except Exception as error:
            if entry.name in without:
                continue
            raise broken_part(entry.name, name, f"cannot be imported: {error}") from error
        yield FeatureModule(entry.name, entry.value, module)


def broken_part(feature: str, name: str, why: str) -> InvalidInput:
    """Return the error that a part of a feature of another package cannot be used.

    Args:
        feature: its name.
        name: of the part.
        why: it cannot, as the end of a sentence.
    """
    return InvalidInput(
        f"the part `{name}` of the feature {feature} {why}; mend or uninstall its package, or "
        f"leave the feature out by {PREFIX}WITHOUT={feature}"
    )
