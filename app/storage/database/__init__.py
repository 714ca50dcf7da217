"""The run store in a database: SQLite in the data folder, or PostgreSQL.

Start reading at `opening`, which opens the store of a server; `read_only` opens it for commands.

- `store` is the `RunStore`; its parts are `artifact_rows`, `curves`, `baselines`, `keys` and
  `progress`; `robots` are stored robots; `deletions` lets rows be restored for a while.
- `schema` defines the tables, `columns` their types, `migration` and `migrations` upgrade them.
- `queries` and `rows` read and decode rows of runs, `stored_rows` those of every other table,
  tolerating damaged ones; `listing` reads runs page by page.
- `engine` runs transactions, retries them, and translates driver errors; `fifo_semaphore` queues
  its threads in order.
- `ownership` (advisory lock, fencing token) admits one server only; `sqlite_file` creates and
  checks the SQLite file.

To add a column: `schema`, and a new file in `migrations/versions`. A table has advice for damaged
rows, too, which `hexapods doctor` prints (`_ADVICE` of `app.cli.data_checks`); its rows are read by
`stored_rows`. Tables of a feature, their migrations and their advice are in its folder.
"""
