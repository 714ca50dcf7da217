"""The classroom: lessons, and rooms in which a class goes through one together.

- `lesson` is the record of a lesson; `page_state` that of what a card opens of the page; `markdown`
  checks and renders its texts; `card_settings` are the settings that a card may open.
- `lesson_file` reads and writes lessons as YAML; `built_in` holds those that come with the server;
  `lessons` finds a lesson of either kind.
- `room` are a room, its participants and what they may do; `rooms` keeps them: with `seats` the
  participants by their cookies, with `room_runs` their runs, and who may see them.
- `answers` checks predictions and scores them; `results` are those of a room.
- `names` draws codes and names.
"""
