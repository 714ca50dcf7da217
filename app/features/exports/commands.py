"""The verbs of `hexapods runs` that write a run's walk to a file."""

from collections.abc import Mapping, Sequence

COMMANDS: Mapping[str, str] = {}
VERBS: Mapping[str, Sequence[str]] = {
    "runs": (
        "app.features.exports.file_commands:add_to",
        "app.features.exports.servos_command:add_to",
    )
}
