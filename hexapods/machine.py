"""Cores and memory of this machine, or as many as this process's container (cgroup) may use."""

import math
import os
import platform
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import psutil

_CGROUPS = Path("/sys/fs/cgroup")


def cores() -> int:
    """Return the number of usable cores."""
    if hasattr(os, "sched_getaffinity"):
        count = len(os.sched_getaffinity(0))
    else:
        count = os.cpu_count() or 1
    match _limit("cpu.max") or _limit("cpu/cpu.cfs_quota_us", "cpu/cpu.cfs_period_us"):
        case [quota_us, period_us] if quota_us > 0:
            return min(count, math.ceil(quota_us / period_us))
    return count


def description() -> dict[str, Any]:
    """Return platform and number of cores of this machine, as summaries and files record them."""
    return {"platform": platform.platform(), "cores": os.cpu_count()}


def instructions() -> str:
    """Return the kind of processor, and the last of the instruction sets that NumPy uses here.

    By them sines and sums of products are rounded differently in their last bit.
    """
    used: Sequence[str] = np.show_config(mode="dicts")["SIMD Extensions"].get("found", ())
    return " ".join([platform.machine(), *used[-1:]])


def memory_bytes() -> int:
    """Return the size of the usable memory."""
    size = psutil.virtual_memory().total
    limit = _limit("memory.max") or _limit("memory/memory.limit_in_bytes")
    return min([size, *limit])


def _limit(*names: str) -> list[int]:
    """Return the numbers in some files of this process's cgroup; none if it has no limit."""
    with suppress(OSError, ValueError):
        own_group = (
            Path("/proc/self/cgroup").read_text("ascii").strip().rpartition(":")[2].lstrip("/")
        )
        # Version 1 mounts each controller by itself, of a container at its own cgroup.
        folder = _CGROUPS / own_group if (_CGROUPS / own_group / names[0]).exists() else _CGROUPS
        texts = [(folder / name).read_text("ascii") for name in names]
        return [int(number) for text in texts for number in text.split()]
    return []
