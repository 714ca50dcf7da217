"""Agents: they choose the next step, and learners learn from it. None reaches into a simulator.

`protocol` is what an agent implements, ours and others; `registry` finds agents by name and builds
them; `appearance` has their titles and colours. `tabular` is what learners with a Q-table have in
common: `q_learning` is the paper's Algorithm 1, `sarsa_lambda` learns on-policy. `q_table` is the
table, whose stored form `table_rows` reads. `lookahead` is the search of Algorithms 3 and 4.
"""
