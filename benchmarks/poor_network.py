"""A poor network between two network namespaces: `python benchmarks/poor_network.py`.

Makes the namespaces `hexapods-server` (10.77.0.1) and `hexapods-class` (10.77.0.2), each with one
TUN device and no other way out, and forwards IP packets between them: each is lost with a
probability, or arrives after a delay. So TCP resends, backs off and waits as it does on a real
network; `tc netem`, which does the same in the kernel, is not in every kernel. Needs root, Linux
and iproute2. Ends, and removes the namespaces, on Ctrl-C or SIGTERM.

    sudo python benchmarks/poor_network.py --delay 0.15 --loss 0.05 &
    sudo ip netns exec hexapods-server hexapods serve --host 10.77.0.1 …
    sudo ip netns exec hexapods-class python benchmarks/classroom.py http://10.77.0.1:8000 …
"""

import argparse
import contextlib
import fcntl
import heapq
import os
import random
import select
import signal
import struct
import subprocess
import time
from collections.abc import Iterator

NAMESPACES = {"hexapods-server": "10.77.0.1", "hexapods-class": "10.77.0.2"}
_MTU = 1500
_TUNSETIFF = 0x400454CA
_IFF_TUN, _IFF_NO_PI = 0x0001, 0x1000
_QUEUE = 10_000


class Forwarder:
    """Forwards packets between two TUN devices, each after a delay, and loses some.

    Attributes:
        passed: number of packets that arrived.
        lost: number of packets that were lost.
    """

    def __init__(self, devices: tuple[int, int], delay_s: float, loss: float, seed: int) -> None:
        """Create it.

        Args:
            devices: file descriptors of both devices.
            delay_s: of each packet [s]; a round trip takes twice as long.
            loss: probability that a packet is lost, in each direction.
            seed: of the losses.
        """
        self._devices, self._delay_s, self._loss = devices, delay_s, loss
        self._chance = random.Random(seed)
        self._on_their_way: list[tuple[float, int, int, bytes]] = []
        self._number = 0
        self.passed = self.lost = 0

    def run(self) -> None:
        """Forward for ever."""
        other = dict(zip(self._devices, reversed(self._devices), strict=True))
        while True:
            now = time.monotonic()
            while self._on_their_way and self._on_their_way[0][0] <= now:
                _, _, device, packet = heapq.heappop(self._on_their_way)
                # A full queue of the device loses the packet, as that of a router does.
                with contextlib.suppress(BlockingIOError):
                    os.write(device, packet)
                    self.passed += 1
            wait_s = None
            if self._on_their_way:
                wait_s = max(0.0, self._on_their_way[0][0] - time.monotonic())
            ready, _, _ = select.select(self._devices, [], [], wait_s)
            for device in ready:
                self._take_in(device, other[device])

    def _take_in(self, device: int, other: int) -> None:
        due_s = time.monotonic() + self._delay_s
        with contextlib.suppress(BlockingIOError):
            while True:
                packet = os.read(device, _MTU + 100)
                if self._chance.random() < self._loss:
                    self.lost += 1
                    continue
                self._number += 1
                heapq.heappush(self._on_their_way, (due_s, self._number, other, packet))


@contextlib.contextmanager
def namespaces() -> Iterator[tuple[int, int]]:
    """Make both namespaces, and yield the descriptors of their devices."""
    devices: list[int] = []
    try:
        for number, (name, address) in enumerate(NAMESPACES.items()):
            device = f"hexapods{number}"
            devices.append(_open(device))
            _ip("netns", "add", name)
            _ip("link", "set", device, "netns", name)
            inside = ("-netns", name)
            _ip(*inside, "address", "add", f"{address}/24", "dev", device)
            for interface in (device, "lo"):
                _ip(*inside, "link", "set", interface, "up")
            _ip(*inside, "link", "set", device, "mtu", str(_MTU), "txqueuelen", str(_QUEUE))
        yield devices[0], devices[1]
    finally:
        for device_file in devices:
            os.close(device_file)
        for name in NAMESPACES:
            with contextlib.suppress(subprocess.CalledProcessError):
                _ip("netns", "delete", name)


def _open(name: str) -> int:
    device = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(device, _TUNSETIFF, struct.pack("16sH", name.encode(), _IFF_TUN | _IFF_NO_PI))
    return device


def _ip(*arguments: str) -> None:
    subprocess.run(["ip", *arguments], check=True)  # noqa: S607


def main() -> None:
    """Forward packets until the process is told to end."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--delay", type=float, default=0.15, help="of a packet, one way [s]")
    parser.add_argument("--loss", type=float, default=0.05, help="share of the packets, each way")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    # So that the namespaces are removed.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with namespaces() as devices:
        forwarder = Forwarder(devices, options.delay, options.loss, options.seed)
        print("the network is there", flush=True)
        with contextlib.suppress(KeyboardInterrupt):
            forwarder.run()
    print(f"{forwarder.passed} packets arrived, {forwarder.lost} were lost")


if __name__ == "__main__":
    main()
