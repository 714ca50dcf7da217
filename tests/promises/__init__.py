"""Tests of the promises of docs/operations.md; each file is named by its promise's number.

Each module's docstring states the promise, and what the gate checks of it. `make soak` runs the
full form (`length`). Helper modules:

- `raw`: raw HTTP requests and a memory monitor; `processes`: scripts in processes of their own.
- `writer`, `full_disk`, `database_holder`, `breaking_writes`: fault injection for the store.
- `idle_connections`, `readers`: anonymous load; `contract_checks`: a check for schemathesis.
- `worst_values`: adverse values of fields; `files`, `trainings`: open files and reference runs.
- `released`: database dumps of released schemas; `audited`: an audit hook for every process.
"""
