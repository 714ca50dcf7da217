"""What comes from elsewhere has one shape, and nothing beside it."""

import msgspec


class Strict(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """Has the fields it has and no others."""
