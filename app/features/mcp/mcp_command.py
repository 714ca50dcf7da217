"""`hexapods mcp`: tools for assistants, by the Model Context Protocol."""

from typing import Annotated

from cyclopts import Parameter

from app.cli.options import Data, WholeNumber
from app.settings import read_settings
from hexapods.domain.errors import InvalidInput

MOST_STARTS = 1000
MOST_STEPS = 10_000_000


def mcp(
    *,
    data: Data = None,
    starts: Annotated[WholeNumber | None, Parameter(metavar="N")] = None,
    steps: Annotated[WholeNumber | None, Parameter(metavar="N")] = None,
) -> int:
    """Let an assistant list runs, explain steps and compare, on standard input and output.

    It speaks the Model Context Protocol, and asks the server that `hexapods serve` runs on the
    data folder. Without --starts and --steps it only reads.

    Args:
        starts: runs that the assistant may start, as long as this command runs
        steps: steps that all of them together may compute, practice and lanes of races

    Raises:
        HexapodError: if the options are not valid, or the extra `mcp` is not installed.
    """
    if (starts is None) != (steps is None):
        missing = "--starts" if starts is None else "--steps"
        raise InvalidInput(f"an allowance has --starts N and --steps N: give {missing} too")
    for option, value, most in (("--starts", starts, MOST_STARTS), ("--steps", steps, MOST_STEPS)):
        if value is not None and not 1 <= value <= most:
            raise InvalidInput(f"{option} must be from 1 to {most:,}, not {value:,}")
    settings = read_settings(data=data)
    # Imported here, as the tools take longer to import than it takes to refuse options.
    from app.features.mcp.allowance import Allowance  # noqa: PLC0415
    from app.features.mcp.protocol import serve_stdio  # noqa: PLC0415
    from app.features.mcp.tools import Tools  # noqa: PLC0415

    allowance = None if starts is None or steps is None else Allowance(starts, steps)
    serve_stdio(Tools(settings, allowance), may_start=allowance is not None)
    return 0
