"""Agents: what chooses the next step, and what learns. They never touch a simulator's insides."""
