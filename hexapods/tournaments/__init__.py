"""Tournaments: entries, which are data, are judged on secret seeds and worlds, and ranked.

- `rules`: the rules of a tournament, and the secret draws of seeds and worlds.
- `entry`: an entry: a learner or searcher with settings, a creature, or a trained table.
- `judging`: one entry on one draw: practice within the budget, then a race.
- `ranking`: interquartile means, paired comparisons, and the ranks that they separate.
- `tournament_file`: a tournament that has ended as a file.
- `verification`: repeats a tournament from its file, and tells what differs.
"""
