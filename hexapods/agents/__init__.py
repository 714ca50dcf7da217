"""Agents: choose actions, and may learn from transitions. They do not depend on a simulator.

`protocol` defines the interface of agents, built-in and user-supplied.
`registry` finds agent classes by name, lists their settings, and creates agents.
`appearance` has their titles, descriptions and colours.
`explanation` has the types and protocols by which learners explain their steps, and searches tell
what they found.
`tabular` has the base classes of learners with a Q-table. Those that learn from each step once
derive from it: `q_learning` (paper, Algorithm 1), `double_q`, `sarsa`, `expected_sarsa` and
`n_step_sarsa`; by `traces` (eligibility traces) also `sarsa_lambda` and `q_lambda`.
`tabular_model` remembers what followed each step. `planning` is the base class of learners that
update their Q-table from it as well: `dyna_q`, `dyna_q_plus` and `prioritized_sweeping`;
`model_planning` that of learners that explore by value iteration in it: `r_max` and
`posterior_sampling`.
`value_table` is what learners ask of a table: `q_table` has a value for each state and action, and
`landing_table` one for each landing, in which `afterstate_q` and `afterstate_r_max` learn.
`table_rows` iterates over the rows of a Q-table's sparse stored form.
`search` is the base of agents that plan by simulation: `lookahead` is exhaustive (paper, Algorithms
3 and 4), `beam` follows the best few sequences, `informed` simulates what the kinematic law ranks
best, and `mcts` samples sequences at random.
`fixed_policies` neither learn nor look ahead: a wave made by hand, and a random walk.
"""
