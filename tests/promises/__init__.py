"""What is promised, one test file for each, named by the promise's number."""
