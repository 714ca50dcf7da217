"""Agents: choose actions, and may learn from transitions. They do not depend on a simulator.

- `protocol` defines the interface of agents, built-in and user-supplied; `registry` finds agent
  classes by name, lists their settings, and creates agents; `appearance` has their titles,
  descriptions and colours.
- `explanation` has the types of explained steps, and the protocols of agents that explain
  themselves; `derived_explanation` explains learners with a Q-table by what they know before and
  after `learn`.
- `tabular` has the base classes of learners with a Q-table. Those that learn from each step once
  derive from it: `q_learning` (paper, Algorithm 1), `double_q`, `sarsa`, `expected_sarsa` and
  `n_step_sarsa`; by `traces` (eligibility traces) also `sarsa_lambda` and `q_lambda`.
- `tabular_model` remembers what followed each step. `planning` is the base class of learners that
  update their Q-table from it as well: `dyna_q`, `dyna_q_plus` and `prioritized_sweeping`;
  `model_planning` that of learners that explore by value iteration in it: `r_max` and
  `posterior_sampling`.
- `tamer` learns from presses of + and − by those who watch.
- `value_table` is the base class of tables: `q_table` has a value for each state and action, and
  `landing_table` one for each landing, in which `afterstate_q` and `afterstate_r_max` learn.
  `table_rows` iterates over the rows of a table's sparse stored form.
- `linear_model` generalises by `experts`, each a `bayesian_regression`, and may learn the order of
  the groups by `group_cycles`; `multilevel_model`, for bodies that tip, by `multilevel_regression`.
- `search` is the base of agents that plan by simulation: `lookahead` is exhaustive (paper,
  Algorithms 3 and 4), `beam` follows the best few sequences, `informed` simulates what the
  kinematic law ranks best, and `mcts` samples sequences at random.
- `fixed_policies` neither learn nor look ahead: a wave made by hand, and a random walk.

To add an agent: a class in a module of its own, written to `protocol`, and its name in `registry`;
or the entry-point group `hexapods.agents` of another package. `sarsa` and `n_step_sarsa` are short
examples of learners, `beam` of a search; `tests/agents/test_learners.py` tests all learners alike.
A setting is an annotated keyword parameter of the constructor (`hexapods.domain.settings`); with
`live=True` and a parameter of `tune` it may change during a training. A learner with an update rule
of its own is explained by a class in `derived_explanation`, or by its own `explain_choice` and
`explain_update`; a search by `futures`.
"""
