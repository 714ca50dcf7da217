"""Limit of the lists and objects in untrusted JSON: a parser takes up to 800 bytes for each.

Each takes two bytes in the file, so that a limit of its size does not bound the memory.
"""

MAX_LISTS = 100_000
"""Lists and objects of a document; the most that the product writes are 60,000."""


def check_lists(data: bytes) -> None:
    """Check that JSON has not too many lists and objects, before it is read.

    Raises:
        ValueError: if it has too many.
    """
    # Brackets within texts count, too; a document has few.
    if data.count(b"[") + data.count(b"{") > MAX_LISTS:
        raise ValueError(f"it has more than {MAX_LISTS:,} lists and objects")
