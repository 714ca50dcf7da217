"""The kind of file that `hexapods verify` repeats for tournaments."""

from collections.abc import Mapping, Sequence

COMMANDS: Mapping[str, str] = {}
VERIFIERS: Sequence[str] = ("app.features.tournaments.verify_command:VERIFIER",)
