"""Names of the files of an experiment's results, in a folder and as artifacts of a run."""

SUMMARY = "summary.json"
"""Statistics and claims computed from the trials so far."""
REPORT = "report.html"
"""The report as one self-contained HTML file."""
TRIALS_TABLE = "trials.csv"
"""Every trial, with its result."""
