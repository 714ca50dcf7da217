"""Export and import of runs as zip archives.

- `feature` is what the core sees of it; `routes` has its routes; `commands` names its commands,
  which are in `export_command` and `import_command`.
- `transfer` exports runs from a store to an archive, and imports them after validating them.
- `archive` packs and unpacks the zip container, with a manifest of SHA-256 hashes.
- `archived_run`, `archived_curve`, `archived_robots` and `archived_files` encode and validate its
  members: `run.json`, the learning curve, stored robots; tables and recordings. Those of a kind of
  run that a feature adds are that kind's (`app.storage.run_kind`).
"""
