"""A demo that is open to strangers: their allowance, whose runs are whose, and their deletion.

A *visitor* is a browser with a random key in a cookie, of which the database has a hash. It is made
at the first start, and forgotten when the last of its runs is deleted.

- `feature` is what the core sees of it; `access` says what visitors may do.
- `routes`, with `response_models`, are those over REST.
- `settings` are its HEXAPODS_… variables.
- `visitors` lets them start runs within their `allowance`; `expiry` deletes what is a day old.
- `tables`, with `rows`, and `migrations` are in the database.
"""
