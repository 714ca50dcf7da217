"""Resource limits against overload by clients, independent of what the server serves.

- `connections` limits open connections in total and per address, and evicts to admit newcomers.
- `listener` applies that at `accept`, `http_protocol` where the event loop accepts by itself; that
  adds timeouts against slow clients.
- `bounded_connection` limits heads and chunks of requests while they are parsed.
- `open_files` raises the limit of file descriptors and divides them.
- `client_slots` limits concurrent streams and viewers; `memory_budget` bytes buffered for clients;
  `fair_semaphore` concurrent work, in turns by client.
- `token_bucket` limits the rate of requests per client; `log_limit` that of log records.
- `addresses` groups client addresses, so that an IPv6 network counts as one client.
"""
