"""A window that is presented to a class in large type, and its remote on a phone.

`feature` is what the core sees of it; `presentation` is what all presenters' windows of a stage
show. The rest is the page (`static/features/presenter`).
"""
