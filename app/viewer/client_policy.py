"""Content-Security-Policy of the page at /viewer/: only its own scripts may run, by their hashes.

viser's client is packed into an attribute of its loader, in base 88 and zstd. The loader unpacks
it and adds it to the page as one more inline script, so its hash is needed as well.
"""

import base64
import hashlib
import re

import numpy as np
import viser
import zstandard

_SCRIPT = re.compile(r"<script(?P<attributes>[^>]*)>(?P<body>.*?)</script>", re.DOTALL)
_PACKED = re.compile(
    r' data-p="(?P<packed>[^"&]+)" data-ss="(?P<style>\d+)" data-cs="(?P<code>\d+)"'
)
_ALPHABET = (
    b"!#$%()*+,-./0123456789:;=?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_abcdefghijklmnopqrstuvwxyz{|}~"
)
_MAX_BYTES = 64 << 20


def content_policy(page: str) -> str:
    """Return the page's Content-Security-Policy.

    Besides scripts it allows what viser's client needs: it compiles WebAssembly, runs its
    websocket in a worker made from a blob, sets styles from scripts, and loads textures as blobs.

    Args:
        page: the page's HTML, patch included.

    Raises:
        RuntimeError: This version of viser packs its client in another way.
    """
    hashes = " ".join(_hash(script) for script in _scripts(page))
    return (
        f"default-src 'none'; script-src 'strict-dynamic' 'wasm-unsafe-eval' {hashes}; "
        "worker-src blob:; style-src 'unsafe-inline'; img-src 'self' blob: data:; "
        "connect-src 'self' blob: data:; base-uri 'none'; form-action 'none'; "
        "frame-ancestors 'self'"
    )


def _scripts(page: str) -> list[bytes]:
    """Return every script that is to run, the packed one last."""
    scripts = list(_SCRIPT.finditer(page))
    packed = [match for script in scripts if (match := _PACKED.fullmatch(script["attributes"]))]
    if len(packed) != 1:
        raise _unsupported(f"of {len(scripts)} scripts {len(packed)} hold the client, not one")
    return [*(script["body"].encode() for script in scripts), _unpacked(packed[0])]


def _unpacked(packed: re.Match[str]) -> bytes:
    style, code = int(packed["style"]), int(packed["code"])
    if style + code > _MAX_BYTES:
        raise _unsupported(f"its client would unpack to {style + code:,} bytes")
    try:
        data = zstandard.ZstdDecompressor().decompress(
            _from_base_88(packed["packed"].encode("ascii")), max_output_size=style + code
        )
    except (UnicodeEncodeError, ValueError, OverflowError, zstandard.ZstdError) as error:
        raise _unsupported(f"its client does not unpack: {error}") from error
    if len(data) != style + code:
        raise _unsupported(f"its client unpacks to {len(data):,} bytes, not {style + code:,}")
    return data[style:]


def _from_base_88(text: bytes) -> bytes:
    """Decode base 88, big-endian: 5 digits are 4 bytes, a shorter rest of n digits n - 1 bytes."""
    values = np.full(256, -1)
    values[np.frombuffer(_ALPHABET, np.uint8)] = np.arange(len(_ALPHABET))
    digits = values[np.frombuffer(text, np.uint8)]
    if (digits < 0).any():
        raise ValueError("not in base 88")
    full_length = len(digits) // 5 * 5
    words = digits[:full_length].reshape(-1, 5) @ 88 ** np.arange(4, -1, -1)
    remainder = digits[full_length:]
    last_word: int = sum(
        int(digit) * 88**exponent for exponent, digit in enumerate(reversed(remainder))
    )
    head: bytes = words.astype(">u4").tobytes()
    return head + last_word.to_bytes(max(0, len(remainder) - 1), "big")


def _hash(script: bytes) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(script).digest()).decode()}'"


def _unsupported(reason: str) -> RuntimeError:
    return RuntimeError(f"viser {viser.__version__} has another page than was expected: {reason}")
