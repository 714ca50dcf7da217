"""Exports of stored runs on a server; `hexapods.exports` has the formats.

- `stored_walks`: the recorded walk of a stored run that has ended.
- `file_renderer`: renders large files one at a time, in a process of lower priority.
"""
