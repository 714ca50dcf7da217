"""Jobs, the store of runs, the event bus, and what is on stage."""
