"""Exit codes of commands beside 0, and 2 after a `HexapodError`."""

FAILED = 1
"""Something that was computed failed, or something that was compared differs."""
INTERRUPTED = 130
"""After SIGINT or SIGTERM: what a shell reports of its own tools."""
