"""Limits on what clients may use of the server: connections, files, memory, starts, log lines.

Nothing here knows what the server serves. `listener`, `http_protocol` and `connections` bound
sockets; `open_files` divides the process's files; `places`, `memory_budget` and `token_bucket`
bound streams, bytes and rates; `log_limit` bounds the log.
"""
