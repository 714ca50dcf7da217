"""The dashboard of Racing Hexapods: a server that runs robots of `hexapods`, and its page.

`server` builds all parts once (`create_app`) and runs them with the lifespan; `feature` is the seam
by which `features` add to them, `installed_features` says which there are, and `active_features`
asks all of them; `feature_modules` finds their parts that need no server. `settings` are those of a
server and of its features (`feature_settings`), of the kinds of `setting_fields`; `setting_checks`
are checks of texts; `cache` is a cache of encoded answers; `answer` is the base class of records
that the API sends.
docs/architecture.md has a row for each package.

Processes and threads:

- Server: the event loop (HTTP, events), worker threads for routes, a thread for each job that
  receives its messages, that of the supervisor, and one for each stage that advances it.
- Fork server, on Linux: that of `multiprocessing`, started first (`hexapods.processes`). The
  processes of jobs and pools are its forks. It ends when the server does, and they with it. `top`
  shows it as `python`, and jobs by kind and id.
- A process for each job, and pools of processes for requests that wait (`app.jobs`): one that
  renders videos, and those of features.
"""
