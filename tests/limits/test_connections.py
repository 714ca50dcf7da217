"""Connection limits in total and per address, and which connection is evicted."""

import socket

from app.limits.addresses import client_group
from app.limits.connections import OPERATOR_SLOTS, Connection, ConnectionTable


class Client:
    """Stub of a connection's protocol (`Peer`)."""

    def __init__(self) -> None:
        self.is_aborted = self.is_overdue = False

    def overdue(self, now_s: float) -> bool:
        return self.is_overdue

    def abort(self) -> None:
        self.is_aborted = True


class Clients:
    """A connection table, and a way to open connections to it."""

    def __init__(self, limit: int, per_address: int) -> None:
        self.table = ConnectionTable(limit, per_address, lambda: 0.0)
        self._files = iter(range(1000))

    def connect(self, host: str, busy: bool = False) -> tuple[Connection, Client] | None:
        connection = self.table.admit(host, next(self._files))
        if connection is None:
            return None
        client = Client()
        connection.attach(client)
        connection.set_busy(busy)
        return connection, client

    def must_connect(self, host: str, busy: bool = False) -> tuple[Connection, Client]:
        connected = self.connect(host, busy)
        assert connected is not None
        return connected


def test_longest_idle_connection_of_the_same_address_is_evicted() -> None:
    clients = Clients(10, 3)
    working = clients.must_connect("10.0.0.1", busy=True)
    first, second = clients.must_connect("10.0.0.1"), clients.must_connect("10.0.0.1")
    first[0].set_busy(True)
    first[0].set_busy(False)  # idle for less long than the second
    clients.must_connect("10.0.0.1")
    assert [client[1].is_aborted for client in (working, first, second)] == [False, False, True]
    assert (len(clients.table), clients.table.evicted) == (3, 1)


def test_oldest_connection_is_evicted_if_all_are_busy() -> None:
    clients = Clients(10, 2)
    first, second = clients.must_connect("a", busy=True), clients.must_connect("a", busy=True)
    clients.must_connect("a")
    assert (first[1].is_aborted, second[1].is_aborted) == (True, False)


def test_address_with_most_connections_is_evicted_for_another_address() -> None:
    clients = Clients(4, 4)
    light = clients.must_connect("light")
    heavy = [clients.must_connect("heavy", busy=True) for _ in range(3)]
    clients.must_connect("new")
    # An idle connection is evicted before a busy one.
    assert light[1].is_aborted
    clients.must_connect("another", busy=True)
    assert [client.is_aborted for _, client in heavy] == [False, False, False]
    clients.must_connect("third", busy=True)
    assert [client.is_aborted for _, client in heavy] == [True, False, False]


def test_no_eviction_between_addresses_with_equal_counts() -> None:
    clients = Clients(2, 2)
    clients.must_connect("a", busy=True)
    clients.must_connect("b", busy=True)
    assert clients.connect("c") is None
    assert clients.table.refused == 1


def test_operator_connections_are_not_evicted_and_have_extra_slots() -> None:
    clients = Clients(2, 1)
    operator = clients.must_connect("operator")
    operator[0].authenticated()
    clients.must_connect("a", busy=True)
    assert clients.connect("c") is None
    for _ in range(OPERATOR_SLOTS):
        clients.must_connect("operator", busy=True)[0].authenticated()
    assert clients.connect("operator") is None
    assert not operator[1].is_aborted


def test_released_connections_are_not_counted() -> None:
    clients = Clients(1, 1)
    for _ in range(5):
        connection, _ = clients.must_connect("a")
        connection.release()
        connection.release()
        connection.set_busy(True)
        assert len(clients.table) == 0
    assert clients.table.evicted == 0


def test_connection_without_a_protocol_is_not_evicted() -> None:
    table = ConnectionTable(1, 1, lambda: 0.0)
    assert table.admit("a", 0) is not None
    assert table.admit("a", 1) is None


def test_a_client_has_left_once_it_has_closed_its_connection() -> None:
    """Also if it has sent something since that nobody has read."""
    table = ConnectionTable(1, 1)
    client, server = socket.socketpair()
    with server:
        connection = table.admit("a", server.fileno())
        assert connection is not None
        client.sendall(b"GET")
        assert not connection.has_left()
        client.close()
        assert connection.has_left()
        connection.release()
        assert connection.has_left()


def test_overdue_connections_are_aborted() -> None:
    clients = Clients(2, 2)
    late, prompt = clients.must_connect("a"), clients.must_connect("a")
    late[1].is_overdue = True
    clients.table.close_overdue()
    assert (late[1].is_aborted, prompt[1].is_aborted) == (True, False)
    assert clients.table.timed_out == 1


def test_ipv6_network_is_one_client_group() -> None:
    assert client_group("2001:db8::1") == client_group("2001:db8::ffff:2") == "2001:db8::/64"
    assert client_group("2001:db8:0:1::1") != client_group("2001:db8::1")
    assert client_group("::ffff:192.0.2.1") == client_group("192.0.2.1") == "192.0.2.1"
    assert client_group("") == ""
