"""The viewer: viser, which listens nowhere, and the hub that shows it to all, read-only."""
