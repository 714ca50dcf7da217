"""The event bus, and the JSON views, metrics and logs of runs.

`bus` publishes events from any thread to any thread, with replay and coalescing; each stage
has a channel on it.
`run_view` has the records of runs for the API and events; `event_records` those of other events.
`run_metrics` is a bus that counts computed steps and logs changes of the runs' states.
`damage` detects and counts stored runs that cannot be decoded or shown.
`logs` configures logging: JSON lines or key=value lines, with run ids.
"""
