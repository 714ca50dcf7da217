"""How many lists and objects JSON from outside may have: a reader takes up to 800 bytes for each.

They need two bytes in the file, so that a limit of its size alone says little of the memory.
"""

MAX_LISTS = 100_000
"""Lists and objects of a document; the most that the product writes are 60,000."""


def check_lists(data: bytes) -> None:
    """Check that JSON has not too many lists and objects, before it is read.

    Raises:
        ValueError: if it has.
    """
    # Those within texts count, too; a document has few.
    if data.count(b"[") + data.count(b"{") > MAX_LISTS:
        raise ValueError(f"it has more than {MAX_LISTS:,} lists and objects")
