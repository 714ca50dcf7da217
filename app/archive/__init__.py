"""Export and import of runs as zip archives, and import of single Q-tables and robots.

- `transfer` exports a run from a store to an archive, and imports one after validating it.
- `archive` packs and unpacks the zip container, with a manifest of SHA-256 hashes.
- `archived_run`, `archived_trials`, `archived_curve`, `archived_robots` and `archived_files` encode
  and validate its members: `run.json`, `trials.json`, the learning curve, stored robots; tables,
  recordings and reports.
- `table_import` imports a Q-table as a finished training; `imported_tables` validates tables;
  `robot_import` imports a robot.
- `untrusted_input` has the base class and field types with which all of this input is parsed.
"""
