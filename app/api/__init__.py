"""The REST interface: parse, call a service, shape the answer."""
