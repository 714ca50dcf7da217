"""Jobs: a process for every training, race and experiment, and the queue before them.

The way of a run: `submissions` checks what was asked and makes queued runs, `queue` orders them,
`supervisor` starts a `worker_process` for each as cores become free, and `job` turns its messages
into the run's state, recording and events. Inside the process `worker` runs the loop and
`job_control` obeys commands between two steps. `jobs` is the face of it all; `resume` queues again
what did not come to its end.
"""
