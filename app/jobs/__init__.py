"""Jobs: the queue of runs, and one worker process for each.

In the server:
- `jobs` is the facade: submit, pause, resume, stop, change and delete runs.
- `submissions` validates requests and builds the runs to be queued; `linked_start` notes whose they
  are before they are stored; `tasks` derives from a stored run what its process needs to start, or
  to resume; `table_import` makes a finished training of a Q-table's file.
- `queue` orders them; `supervisor` starts them as cores free up, and shuts them down.
- `worker_process` is the handle on a process; `job` writes its messages to store and bus.
- `process_pool` runs functions for requests that wait, in processes of its own; `turns`
  lets them wait for each other, operators first; `stopping` ends those that take long in threads.
Between both: `messages` defines the commands and messages on the pipe.
In the worker process:
- `worker` is the entry point and runs the loop.
- `job_control` executes commands between two steps.

A job has one process, at lower priority, and one thread of the server that receives its messages.
It sends heartbeats, without which it is ended after a minute. A kind of run that a feature adds has
a task, messages and a subclass of `Job` of its own (`app.storage.run_kind`). A pool of processes
starts with its first request and ends when idle; it is a `hexapods.worker_pool.WorkerPool`. Why
processes, and why they are forks: docs/decisions/0008.
"""
