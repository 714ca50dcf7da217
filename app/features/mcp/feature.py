"""The command for assistants as a feature, so that HEXAPODS_WITHOUT can leave it out."""

from app.feature import Feature


class Mcp(Feature):
    """Nothing of a server: the command asks one over REST, as any client does."""

    name = "mcp"


FEATURE = Mcp
