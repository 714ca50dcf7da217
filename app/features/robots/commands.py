"""Names the command of stored robots; imports nothing, as each command would wait for it."""

COMMANDS = {"robots": "app.features.robots.robots_command:robots"}
