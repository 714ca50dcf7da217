"""A demo that is open to strangers: their allowance, whose runs are whose, and their deletion.

A *visitor* is a browser with a random key in a cookie, of which the database has a hash. It is made
at the first start, and forgotten when the last of its runs is deleted.
"""
