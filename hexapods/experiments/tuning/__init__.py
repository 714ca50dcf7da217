"""Tuning: search for the settings of a learner that walk farthest, and judge them on other seeds.

- `ranges`: where to search, from the declarations of the settings; `config`: the parameters of a
  tuning; `study`: the sampler, and the only module that imports Optuna.
- `tuning`: candidates and their trials, then the trials on held-out seeds.
- `summary`: the outcome as one document, and as sentences; `report`: as HTML page and CSV.
"""
