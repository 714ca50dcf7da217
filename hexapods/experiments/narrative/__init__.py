"""Explanatory text of a report; every number in it is computed from the experiment's results.

- `narrative`: assembles the text of an experiment from its paragraphs.
- `table1`, `figure4`, `sweep`: the paragraphs of each experiment.
- `finding`: what came of an experiment, in a sentence.
- `gaits`: the paragraph about the gait that differs from the others.
"""
