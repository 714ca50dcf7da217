"""A run as code that repeats it to the last bit, on the command line and in Python.

`feature` is what the core sees of it; `routes` has its route, `run_code` writes the code.
"""
