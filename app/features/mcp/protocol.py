"""The server of the protocol, by the library that is the extra `mcp`."""

import functools
from collections.abc import Callable
from typing import Any

from app.features.mcp.tools import Tools
from hexapods.domain.errors import HexapodError
from hexapods.extras import needs
from hexapods.version import __version__

_INSTRUCTIONS = (
    "Six-legged robots learn to walk, and race. List runs first: other tools take their ids. "
    "Distances are in metres."
)


def serve_stdio(tools: Tools, *, may_start: bool) -> None:
    """Serve the tools on standard input and output until the input ends.

    Args:
        tools: the tools.
        may_start: whether those that start runs are among them.

    Raises:
        MissingExtra: if the library is not installed.
    """
    with needs("mcp", "hexapods mcp"):
        from mcp.server.mcpserver import MCPServer  # noqa: PLC0415 - as an extra
        from mcp.server.mcpserver.exceptions import ToolError  # noqa: PLC0415
        from mcp.types import ToolAnnotations  # noqa: PLC0415

    def with_sentence(tool: Callable[..., Any]) -> Callable[..., Any]:
        """Return a tool whose errors are sentences for who calls it."""

        @functools.wraps(tool)
        def call(*args: Any, **kwargs: Any) -> Any:
            try:
                return tool(*args, **kwargs)
            except HexapodError as error:
                raise ToolError(str(error)) from error

        return call

    server = MCPServer(
        "racing-hexapods",
        title="Racing Hexapods",
        instructions=_INSTRUCTIONS,
        version=__version__,
        log_level="ERROR",
        subscriptions=False,
    )
    reading: tuple[Callable[..., Any], ...] = (
        tools.list_runs,
        tools.explain_step,
        tools.compare_settings,
        tools.compare_trainings,
    )
    for tool in reading:
        server.add_tool(with_sentence(tool), annotations=ToolAnnotations(read_only_hint=True))
    if may_start:
        adds = ToolAnnotations(read_only_hint=False, destructive_hint=False)
        starting: tuple[Callable[..., Any], ...] = (tools.start_training, tools.start_race)
        for tool in starting:
            server.add_tool(with_sentence(tool), annotations=adds)
    server.run("stdio")
