"""The classroom: lessons, and rooms in which a class goes through one together.

- `feature` is what the core sees of it; `access` says what participants may do, and who sees rooms.
- `lesson` is the record of a lesson; `page_state` that of what a card opens of the page; `markdown`
  checks and renders its texts; `card_settings` are the settings that a card may open.
- `lesson_file` reads and writes lessons as YAML; `built_in` holds those that come with the server;
  `lessons` finds a lesson of either kind; `lesson_sheet` is one to print for the teacher.
- `room` are a room, its participants and what they may do; `room_registry` keeps all rooms, with
  `seats` the participants by their cookies and with `room_runs` their runs, and who may see them;
  `rooms` is what teacher and participants do in them; `room_stages` opens a stage for each open
  room, with the roles and sessions of the server's first one.
- `questions` has the kinds of questions: what an answer is, and how it is scored; `card_starts`
  makes what a card runs, and `what_ifs` answers what it asks; `results` are those of a room,
  with the `gain` of the class; `class_race` lets its best, median and last robot race together;
  `names` draws codes and names.
- `teach` is the part of a card on which a class teaches a robot, `teaching` its service, and
  `press_book` adds up the presses of a class by step.
- Over REST: `lesson_routes`, `room_routes` for the teacher, `participant_routes`, `teach_routes`,
  `pages`, `request_bodies`, `response_models`, `room_views`. In the database: `tables`, with
  `lesson_rows`, `room_rows` and `room_loading`, and `migrations`.

To add a lesson that is built in: a file in `built_in`. A kind of question: `Kind` and a class in
`questions`, and an entry in `static/features/classroom/room/questions.js`.
"""
