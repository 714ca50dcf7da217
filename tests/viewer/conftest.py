"""Fixtures: a stage with a clock of its own."""

from tests.stage.conftest import parts

__all__ = ["parts"]
