"""Racing Hexapods: hexapods that learn to walk, and race against look-ahead search."""

from importlib.metadata import version

__version__ = version("racing-hexapods")
