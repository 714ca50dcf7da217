"""The report of an experiment as files.

- `files`: writes all files; `page`: the self-contained HTML page, from `templates/`.
- `tables`: the page's tables as text cells; `trials_csv`: every trial as CSV; `walks`: walks from
  rest, read back from a finished report.
- `figures`: all figures of an experiment, from `figure_table1`, `figure_curves`, `figure_sweep` and
  `figure_worlds`; `drawing`: their common style, colours and file formats.
"""
