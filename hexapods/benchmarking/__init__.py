"""Benchmark of agents by a frozen protocol; its score file can be repeated (docs/benchmark.md).

- `hexabench_1.json`: the protocol `hexabench-1` as data: tasks, budgets, best known distances.
  Frozen: another task or number is another protocol. `mantis.xml` is a robot of it, as it was
  imported, and `mantis.json` what came of that.
- `protocol`: reads protocols; `draws`: bodies and damages that a seed draws.
- `config`: what is benchmarked, validated; `runs`: its trials, and what came of each.
- `scores`: shares of best known, their interquartile means and intervals.
- `kept_runs`: keeps runs in a file until all are done.
- `score_file`: the result as JSON; `verification`: repeats it.

To add a protocol: a file beside `hexabench_1.json`, and its name in `PROTOCOLS` of `protocol`.
"""
