"""Archives: a run with all it has as one file, out of one store and into another.

`transfer` moves a run; `archive` is the zip; `archived_run`, `archived_files` and `archived_trials`
check what is in it. `table_import` takes in a Q-table alone. Everything from outside is read with
`untrusted_input`.
"""
