"""The report of an experiment as files.

- `files`: writes all files; `page`: the self-contained HTML page, from `templates/`, where that of
  a tuning is too.
- `tables`: the page's tables as text cells; `trials_csv`: every trial as CSV.
- `figures`: all figures of an experiment, from `figure_table1`, `figure_curves` and
  `figure_sweep`; `drawing`: their common style, colours and file formats.
"""
