"""Figures for papers: pictures with caption, data and the command that repeats them.

- `config`: what a figure shows; `content`: its settings and numbers; `caption`: its text.
- `style`: sizes, fonts, colours and dashes; `drawing`: the picture, by Matplotlib.
- `files`: PDF, SVG, PNG, caption, CSV and command, alone or in one archive.
"""
