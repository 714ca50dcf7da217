"""Database dumps of every released schema, and the runs that they contain."""
