"""The event bus and what listens to it on the server: run views, metrics, the log.

`bus` carries events from any thread to every subscriber; `run_view` is a run as JSON; `run_metrics`
counts and logs what happens to runs; `damage` finds stored runs that cannot be read.
"""
