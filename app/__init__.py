"""Racing Hexapods: hexapods that learn to walk, and race against look-ahead search."""

__version__ = "0.1.0"
