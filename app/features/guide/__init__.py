"""The guide: the documentation of the project as pages of the server.

`feature` is what the core sees of it; `pages` renders Markdown, in the order of
`docs/index.md`.
"""
