"""What a reader sees, in sentences whose numbers come from the run."""
