"""Load generator of readers: `python -m tests.promises.readers PORT COUNT PATH…`.

COUNT threads request the paths and read each answer completely, each from an address of its own.
It prints an empty line once one of them has a whole answer (200), and when standard input ends the
answers by status as JSON. A process of its own, so that
the load does not slow down the test itself.
"""

import http.client
import json
import sys
import threading
from collections import Counter
from collections.abc import Sequence
from functools import cache


def main(port: int, count: int, paths: Sequence[str]) -> None:
    """Read answers until standard input ends."""
    statuses: Counter[str] = Counter()
    finished = threading.Event()

    @cache
    def tell_once() -> None:
        sys.stdout.write("\n")
        sys.stdout.flush()

    def read(number: int) -> None:
        source = (f"127.0.0.{2 + number}", 0)
        while not finished.wait(0.02):
            connection = http.client.HTTPConnection("127.0.0.1", port, 10, source)
            try:
                connection.request("GET", paths[number % len(paths)])
                answer = connection.getresponse()
                while answer.read(1 << 16) and not finished.is_set():
                    pass
                statuses[str(answer.status)] += 1
                if answer.status == 200:
                    tell_once()
            except (OSError, http.client.HTTPException) as error:
                statuses[type(error).__name__] += 1
            finally:
                connection.close()

    threads = [threading.Thread(target=read, args=(number,)) for number in range(count)]
    for thread in threads:
        thread.start()
    sys.stdin.read()
    finished.set()
    for thread in threads:
        thread.join()
    sys.stdout.write(json.dumps(statuses) + "\n")


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3:])
