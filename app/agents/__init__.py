"""Agents: choose actions, and may learn from transitions. They do not depend on a simulator.

`protocol` defines the interface of agents, built-in and user-supplied.
`registry` finds agent classes by name, lists their settings, and creates agents.
`appearance` has their titles, descriptions and colours.
`tabular` is the base class of learners with a Q-table and an ε-greedy policy; `q_learning`
(paper, Algorithm 1) and `sarsa_lambda` (on-policy, eligibility traces) derive from it.
`q_table` is the table; `table_rows` iterates over the rows of its sparse stored form.
`search` is the base of agents that plan by simulation: `lookahead` is exhaustive (paper, Algorithms
3 and 4), `beam` follows the best few sequences, `informed` simulates what the kinematic law ranks
best, and `mcts` samples sequences at random.
"""
