"""Tests of one feature that go through others, which may be missing."""

from importlib.util import find_spec

import pytest


def needs(*names: str) -> pytest.MarkDecorator:
    """Return a mark that skips a test where the folder of one of these features was deleted."""
    missing = [name for name in names if find_spec(f"app.features.{name}") is None]
    return pytest.mark.skipif(bool(missing), reason=f"without {', '.join(missing)}")
