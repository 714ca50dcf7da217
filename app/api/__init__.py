"""The REST interface: routes parse a request, call a service, and shape the answer.

- Routes: `starts` (whose bodies name agents), `trainings`, `races` (with `runs` in common),
  `robot_preview`, `replays`, `stage`, `spectators` (at addresses that are `reachable`), `events`,
  `options`, `monitoring`; `pages` and `docs`.
- Requests: `agent_bodies`, `schemas`, `fields`, `descriptions`, `formats`.
- Answers: `record_response` (returns a record), `answers`, `run_views` (with kinds of runs that
  features add), `recorded_answers`, `option_answers` (from `option_texts` and `robot_options`),
  `event_answers`, `curves`, `problems` (RFC 9457, with their `problem_types`), `templates` (web
  pages), `compression`; `budgeted_chunks` (of what slow clients read).
- `contract` completes the OpenAPI document, by `shared_schemas` where bodies have the same;
  `deps` injects services and the stage.
- `policy` says of each route who may use it and what it costs, by kinds of `work`. `guards`
  run when a route was matched, before its body is read: `auth` (roles, and those whom features know
  by `identity`), `rate_limit`, `memory_limit`, `concurrency_limit`.
- Middleware before the routes: `middleware` (its base, security headers), `public_path` (below
  which path of a site), `stage_paths` (which stage), `request_headers`, `cookies`, `host_check`,
  `wellformed`, `problem_pages`, `unfinished`.

To add a route: an endpoint with `@policy(access=…)`, on a router of `policy.api_router`, and a
response model.

The docstring of a response model tells what each member means, in the OpenAPI document too;
`make page-types` writes the page's types from it. Pages below `static` are compressed, with a
preload of every other module (`pages`), when the server starts.
"""
