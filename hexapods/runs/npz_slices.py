"""Parts of the arrays of an uncompressed `.npz` file, read without the rest of it."""

import io
import struct
import threading
import zipfile
from collections.abc import Mapping
from typing import IO, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

_LOCAL_HEADER = struct.Struct("<4s5H3I2H")
_SUFFIX = ".npy"


class _Array(NamedTuple):
    offset: int
    shape: tuple[int, ...]
    dtype: np.dtype[Any]


class NpzSlices:
    """An `.npz` file as `numpy.savez` writes it, of which parts are read. Thread-safe.

    Attributes:
        arrays: position, shape and type of each array, by its name.
    """

    def __init__(self, file: IO[bytes]) -> None:
        """Read the positions, shapes and types of the arrays.

        Args:
            file: the file, which can be sought in; the caller closes it.

        Raises:
            ValueError: if an array is compressed, overlaps another, or can be read only as a whole.
                zipfile and NumPy raise other exceptions for a damaged file.
        """
        self._file, self._lock = file, threading.Lock()
        self.arrays: Mapping[str, _Array] = _arrays_of(file)

    def __contains__(self, name: object) -> bool:
        """Whether there is an array of this name."""
        return name in self.arrays

    def length(self, name: str) -> int:
        """Return the length of an array."""
        shape = self.arrays[name].shape
        if not shape:
            raise ValueError(f"{name} is no list")
        return shape[0]

    def rows(self, name: str, first: int = 0, end: int | None = None) -> NDArray[Any]:
        """Return a part of an array, or all of one without dimensions."""
        offset, shape, dtype = self.arrays[name]
        if not shape:
            return self._read(offset, 1, dtype).reshape(())
        first, end, _ = slice(first, end).indices(shape[0])
        count, width = max(0, end - first), int(np.prod(shape[1:]))
        begin = offset + first * width * dtype.itemsize
        return self._read(begin, count * width, dtype).reshape(count, *shape[1:])

    def _read(self, offset: int, count: int, dtype: np.dtype[Any]) -> NDArray[Any]:
        size = count * dtype.itemsize
        if not size:
            return np.empty(count, dtype)
        with self._lock:
            self._file.seek(offset)
            data = self._file.read(size)
        if len(data) != size:
            raise ValueError("it is shorter than it says")
        return np.frombuffer(data, dtype)


def _arrays_of(file: IO[bytes]) -> dict[str, _Array]:
    with zipfile.ZipFile(file) as archive:
        members = archive.infolist()
        if any(member.compress_type != zipfile.ZIP_STORED for member in members):
            raise ValueError("its members are compressed; write it with numpy.savez")
        if sum(member.file_size for member in members) > file.seek(0, io.SEEK_END):
            raise ValueError("its members claim to be larger than the file")
        return {
            member.filename.removesuffix(_SUFFIX): _array(file, archive, member)
            for member in members
        }


def _array(whole: IO[bytes], archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> _Array:
    with archive.open(member) as file:
        version = np.lib.format.read_magic(file)
        read = {
            (1, 0): np.lib.format.read_array_header_1_0,
            (2, 0): np.lib.format.read_array_header_2_0,
        }.get(version)
        if read is None:
            raise ValueError(f"{member.filename} has format {version}")
        shape, is_fortran, dtype = read(file)
        header = file.tell()
    if dtype.hasobject or (is_fortran and len(shape) > 1):
        raise ValueError(f"{member.filename} cannot be read in parts")
    if header + dtype.itemsize * int(np.prod(shape, dtype=object)) != member.file_size:
        raise ValueError(f"{member.filename} is of another length than it says")
    whole.seek(member.header_offset)
    *_, name, extra = _LOCAL_HEADER.unpack(whole.read(_LOCAL_HEADER.size))
    begin = member.header_offset + _LOCAL_HEADER.size + name + extra
    return _Array(begin + header, shape, dtype)
