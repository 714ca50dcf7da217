"""The report of an experiment as files.

- `files`: writes all files; `page`: the page, one HTML file of the dashboard's own components;
  `page_options`: the names, titles and colours in it; `compared_pairs`: its comparisons.
- `command`: the shell command that repeats the experiment; `trials_csv`: every trial as CSV;
  `walks`: walks from rest, read back from a finished report.
"""
