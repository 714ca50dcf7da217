"""Tournaments of a server: entries are taken, judged in processes, and kept.

- `tournament`: a tournament, as it is in the database.
- `tournaments`: opens tournaments, takes entries, ends and deletes them.
- `judge`: judges entries on their draws, one after another, in processes.
- `entered_tables`: the tables of trainings that enter.
- `ended_file`: a tournament that has ended as a file.
"""
