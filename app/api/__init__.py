"""The REST interface: routes parse a request, call a service, and shape the answer.

Routes: `starts` (whose bodies name agents), `trainings`, `races`, `experiments` (with `runs` in
common), `gait`, `replays`, `exports`, `stage`, `spectators`, `events`, `options`, `archives`
(export and import), `monitoring`, `pages`, `docs`. Requests: `agent_bodies`, `schemas`,
`experiment_body`, `fields`, `descriptions`, `formats`. Answers: `answers`, `recorded_answers`,
`experiment_answers`, `explanation_answers`, `option_answers`, `curves`, `problems`
(RFC 9457), `templates` (web pages), `compression`. `contract` completes the OpenAPI document.
Middleware, before all routes: `middleware` (its base, security headers), `stage_paths` (which
stage), `request_headers`, `cookies`, `host_check`, `wellformed`, `problem_pages`, `unfinished`.
`policy` says on each route who may use it and what it costs; `guards` runs what reads that, when a
route was matched: `auth` (roles, and identities of features: `identity`), `rate_limit`,
`memory_limit`, `concurrency_limit`. `deps` injects services and the stage.
"""
