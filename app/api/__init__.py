"""The REST interface: routes parse a request, call a service, and shape the answer.

Routes: `starts` (whose bodies name agents), `trainings`, `races`, `experiments` (with `runs` in
common), `gait`, `replays`, `exports`, `stage`, `spectators`, `events`, `options`, `archives`
(export and import), `monitoring`, `pages`, `docs`. Requests: `agent_bodies`, `schemas`,
`experiment_body`, `fields`, `descriptions`, `formats`. Answers: `answers`, `recorded_answers`,
`experiment_answers`, `explanation_answers`, `option_answers`, `curves`, `problems`
(RFC 9457), `templates` (web pages), `compression`. `contract` completes the OpenAPI document.
Middleware: `middleware` (its base, security headers), `stage_paths` (which stage), `auth` (roles),
`request_headers`, `cookies`, `host_check`, `wellformed`, `problem_pages`, `unfinished`,
`memory_limit`, `concurrency_limit`, `rate_limit`. `deps` injects services and the stage.
"""
