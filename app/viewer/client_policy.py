"""What the page at /viewer/ may run: the scripts that are in it, by their hashes, and no others.

viser's client comes packed in an attribute of its own loader, in base 88 and zstd. The loader
unpacks it and adds it to the page as one more inline script, so its hash is needed as well.
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
_DIGITS = (
    b"!#$%()*+,-./0123456789:;=?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_abcdefghijklmnopqrstuvwxyz{|}~"
)
_MOST_BYTES = 64 << 20


def content_policy(page: str) -> str:
    """The page's Content-Security-Policy.

    Beside the scripts, viser's client needs these: it compiles WebAssembly, has its socket in a
    worker made from a blob, styles elements from scripts, and gets textures as blobs.

    Args:
        page: the page's HTML, with the skin on.

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
    """Every script that is to run, the packed one last."""
    found = list(_SCRIPT.finditer(page))
    packed = [one for script in found if (one := _PACKED.fullmatch(script["attributes"]))]
    if len(packed) != 1:
        raise _surprise(f"of {len(found)} scripts {len(packed)} hold the client, not one")
    return [*(script["body"].encode() for script in found), _unpacked(packed[0])]


def _unpacked(packed: re.Match[str]) -> bytes:
    style, code = int(packed["style"]), int(packed["code"])
    if style + code > _MOST_BYTES:
        raise _surprise(f"its client would unpack to {style + code:,} bytes")
    try:
        data = zstandard.ZstdDecompressor().decompress(
            _from_base_88(packed["packed"].encode("ascii")), max_output_size=style + code
        )
    except (UnicodeEncodeError, ValueError, OverflowError, zstandard.ZstdError) as error:
        raise _surprise(f"its client does not unpack: {error}") from error
    if len(data) != style + code:
        raise _surprise(f"its client unpacks to {len(data):,} bytes, not {style + code:,}")
    return data[style:]


def _from_base_88(text: bytes) -> bytes:
    """Five digits are four bytes, the highest first; a shorter rest is one byte less."""
    values = np.full(256, -1)
    values[np.frombuffer(_DIGITS, np.uint8)] = np.arange(len(_DIGITS))
    digits = values[np.frombuffer(text, np.uint8)]
    if (digits < 0).any():
        raise ValueError("not in base 88")
    whole = len(digits) // 5 * 5
    numbers = digits[:whole].reshape(-1, 5) @ 88 ** np.arange(4, -1, -1)
    rest = digits[whole:]
    last: int = sum(int(digit) * 88**place for place, digit in enumerate(reversed(rest)))
    first: bytes = numbers.astype(">u4").tobytes()
    return first + last.to_bytes(max(0, len(rest) - 1), "big")


def _hash(script: bytes) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(script).digest()).decode()}'"


def _surprise(what: str) -> RuntimeError:
    return RuntimeError(f"viser {viser.__version__} has another page than was expected: {what}")
