"""Commands that the feature adds to `hexapods`."""

COMMANDS = {"mcp": "app.features.mcp.mcp_command:mcp"}
