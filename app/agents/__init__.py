"""Agents: they choose the next step, and learners learn from it. None reaches into a simulator.

`protocol` is what an agent implements, ours and others; `registry` finds agents by name and builds
them; `q_learning` is the paper's Algorithm 1 on the table of `q_table`, whose stored form
`table_rows` reads; `lookahead` is the search of Algorithms 3 and 4.
"""
