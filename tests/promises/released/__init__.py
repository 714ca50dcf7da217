"""Dumps of databases as every released version left them, with the runs that are in them."""
