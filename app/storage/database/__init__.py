"""The run store in a database: SQLite in the data folder, or PostgreSQL.

Start reading at `opening`, which opens the store of a server; `read_only` opens it for commands.
`store` is the `RunStore`; its parts are `artifact_rows`, `curves`, `trials`, `keys`
and `progress`.
`schema` defines the tables, `columns` their types, `migration` and `migrations` upgrade them.
`queries` and `rows` read and decode rows of runs, tolerating damaged ones.
`engine` runs transactions, retries them, and translates driver errors; `fair_semaphore` queues
its threads in order.
`ownership` (advisory lock, fencing token) admits one server only; `sqlite_file` creates and checks
the SQLite file.
"""
