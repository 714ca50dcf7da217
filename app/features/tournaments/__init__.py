"""Tournaments of a server: entries are taken, judged in processes, and kept.

- `feature` is what the core sees of it; `access` says who may enter, and who sees a tournament.
- `tournament`: a tournament, as it is in the database.
- `tournaments`: opens tournaments, takes entries, ends and deletes them.
- `judge`: judges entries on their draws: half as many threads as cores, each with a pool of one
  process at the lowest priority. It is woken by what changes in tournaments.
- `entered_tables`: the tables of trainings that enter.
- `ended_file`: a tournament that has ended as a file.
- `room_directory`: rooms of the classroom, where there is one.
- On the command line (`commands`): `verify_command`, which repeats such a file.
- Over REST: `routes`, `pages`, `request_bodies`, `response_models`, `views`. In the database:
  `tables`, with `rows`, and `migrations`.
"""
