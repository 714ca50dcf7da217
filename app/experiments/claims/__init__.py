"""What the paper says, and whether the trials bear it out."""
