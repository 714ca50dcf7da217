"""Tests of the demo: allowance, visitors, clean-up."""
