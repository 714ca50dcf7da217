"""Explanations of steps, and tables of any moment: learners are built again from what is stored.

`rebuilt_practice` goes to any step of one walk, forward and back, by snapshots; `service` finds the
walks of runs, and answers; `loss` answers why a learner loses; `views` makes the answers of
explanations and tables, with the `sentences` about a step and the `names` of moves. `feature` is
what the core sees of it; `routes`, with `response_models`, are those over REST.
"""
