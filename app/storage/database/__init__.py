"""Runs in a database: SQLite in the data folder, or PostgreSQL. Start reading at `opening.py`."""
