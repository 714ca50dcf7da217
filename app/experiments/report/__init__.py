"""The report as files: a page, figures, every trial."""
