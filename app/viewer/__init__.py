"""The viewer: viser's stage on loopback, and the hub that shows it to every browser, read-only."""
