"""A server of the Model Context Protocol: runs for assistants that speak it.

- `commands` names its command, which is in `mcp_command`, and `feature` the feature: the core sees
  no more of it.
- `protocol` has the tools of the protocol's library, the extra `mcp`, made of those of `tools`,
  which ask a running server over REST; `answers` are their answers.
- `allowance` limits what the tools may start.
"""
