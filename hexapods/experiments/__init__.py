"""Experiments over many seeds, the paper's and in other worlds, and their evaluation.

- `presets`: the experiments as data; `config`: their parameters; `names`: what they are called;
  `plan`: the grid of settings and their trials; `trial`: one trial (practice, walk, race);
  `result`: its result.
- `engine`: runs trials on workers; `local_workers`: processes on this machine, `cluster`: those,
  or a Dask cluster; `worker`: the code that runs on a worker, and the check that all machines have
  the same versions.
- `progress`: runs the remaining trials of an experiment and collects their outcomes; `folder`: the
  same with an append-only results file, from which it resumes.
- `statistics`, `measures`, `setting_results`, `summary`: interquartile means, bootstrap intervals
  and comparisons, from single results up to the summary document; `worlds`: the part of a league
  or recovery; `trial_rows`: trials as rows of a table.
- `comparing`: compares two groups of seeds, `setting_comparison` two settings of a summary;
  `comparison`: the result, and the same in sentences; `profiles`: performance profiles; `figures`:
  figures for papers.
- `published`: the paper's Table 1; `claims`: the paper's claims and their verdicts;
  `narrative`: explanatory text; `report`: HTML page and CSV; `formatting`, `labels` and
  `failures`: numbers, names and failed trials as text.

To add an experiment: a value in `presets`. To add a claim about one: a module in
`claims`, and its sentence in `narrative`.
"""
