"""Revisions of the core's tables, one file each."""
