"""Lock a database exclusively, for some seconds after a line on standard input."""

import sqlite3
import sys
import time

import psycopg


def main(where: str, seconds: float) -> None:
    if where.startswith("postgresql:"):
        with psycopg.connect(where) as server:
            server.execute("LOCK TABLE runs, evaluations, artifacts IN ACCESS EXCLUSIVE MODE")
            hold(seconds)
            server.rollback()
        return
    file = sqlite3.connect(where, isolation_level=None)
    file.execute("BEGIN EXCLUSIVE")
    hold(seconds)
    file.execute("ROLLBACK")


def hold(seconds: float) -> None:
    sys.stdout.write("held\n")
    sys.stdout.flush()
    sys.stdin.readline()
    time.sleep(seconds)


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
