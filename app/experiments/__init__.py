"""The paper's experiments over many seeds: what is tried, on which cluster, and what it shows."""
