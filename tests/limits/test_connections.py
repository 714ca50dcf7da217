"""Connections are counted, by address too, and the right one makes room."""

from app.limits.addresses import client_group
from app.limits.connections import OPERATOR_SLOTS, Connection, ConnectionTable


class Client:
    """The other side of a connection, as the table sees it."""

    def __init__(self) -> None:
        self.is_aborted = self.is_overdue = False

    def overdue(self, now_s: float) -> bool:
        return self.is_overdue

    def abort(self) -> None:
        self.is_aborted = True


class Crowd:
    """A table, and connections to it."""

    def __init__(self, limit: int, per_address: int) -> None:
        self.table = ConnectionTable(limit, per_address, lambda: 0.0)
        self._files = iter(range(1000))

    def come(self, host: str, busy: bool = False) -> tuple[Connection, Client] | None:
        connection = self.table.admit(host, next(self._files))
        if connection is None:
            return None
        client = Client()
        connection.attach(client)
        connection.set_busy(busy)
        return connection, client

    def must_come(self, host: str, busy: bool = False) -> tuple[Connection, Client]:
        come = self.come(host, busy)
        assert come is not None
        return come


def test_the_longest_idle_of_the_same_address_makes_room() -> None:
    crowd = Crowd(10, 3)
    working = crowd.must_come("10.0.0.1", busy=True)
    first, second = crowd.must_come("10.0.0.1"), crowd.must_come("10.0.0.1")
    first[0].set_busy(True)
    first[0].set_busy(False)  # so it is idle since later than the second
    crowd.must_come("10.0.0.1")
    assert [one[1].is_aborted for one in (working, first, second)] == [False, False, True]
    assert (len(crowd.table), crowd.table.evicted) == (3, 1)


def test_where_all_work_the_oldest_makes_room() -> None:
    crowd = Crowd(10, 2)
    first, second = crowd.must_come("a", busy=True), crowd.must_come("a", busy=True)
    crowd.must_come("a")
    assert (first[1].is_aborted, second[1].is_aborted) == (True, False)


def test_the_heaviest_address_makes_room_for_another() -> None:
    crowd = Crowd(4, 4)
    light = crowd.must_come("light")
    heavy = [crowd.must_come("heavy", busy=True) for _ in range(3)]
    crowd.must_come("new")
    # An idle one goes before one that works.
    assert light[1].is_aborted
    crowd.must_come("another", busy=True)
    assert [client.is_aborted for _, client in heavy] == [False, False, False]
    crowd.must_come("third", busy=True)
    assert [client.is_aborted for _, client in heavy] == [True, False, False]


def test_addresses_do_not_only_take_turns() -> None:
    crowd = Crowd(2, 2)
    crowd.must_come("a", busy=True)
    crowd.must_come("b", busy=True)
    assert crowd.come("c") is None
    assert crowd.table.refused == 1


def test_an_operator_stays_and_gets_in() -> None:
    crowd = Crowd(2, 1)
    operator = crowd.must_come("operator")
    operator[0].authenticated()
    crowd.must_come("a", busy=True)
    assert crowd.come("c") is None
    for _ in range(OPERATOR_SLOTS):
        crowd.must_come("operator", busy=True)[0].authenticated()
    assert crowd.come("operator") is None
    assert not operator[1].is_aborted


def test_what_is_closed_counts_no_more() -> None:
    crowd = Crowd(1, 1)
    for _ in range(5):
        connection, _ = crowd.must_come("a")
        connection.release()
        connection.release()
        connection.set_busy(True)
        assert len(crowd.table) == 0
    assert crowd.table.evicted == 0


def test_one_that_is_not_begun_yet_stays() -> None:
    table = ConnectionTable(1, 1, lambda: 0.0)
    assert table.admit("a", 0) is not None
    assert table.admit("a", 1) is None


def test_who_is_overdue_is_closed() -> None:
    crowd = Crowd(2, 2)
    late, prompt = crowd.must_come("a"), crowd.must_come("a")
    late[1].is_overdue = True
    crowd.table.close_overdue()
    assert (late[1].is_aborted, prompt[1].is_aborted) == (True, False)
    assert crowd.table.timed_out == 1


def test_who_has_a_network_counts_once() -> None:
    assert client_group("2001:db8::1") == client_group("2001:db8::ffff:2") == "2001:db8::/64"
    assert client_group("2001:db8:0:1::1") != client_group("2001:db8::1")
    assert client_group("::ffff:192.0.2.1") == client_group("192.0.2.1") == "192.0.2.1"
    assert client_group("") == ""
