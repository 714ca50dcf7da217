"""viser's client in the browser: its page, patched, and its colours.

The page is viser's single file with scripts and a style sheet injected. By its
Content-Security-Policy only its own scripts may run, by their hashes. The client itself is packed
into an attribute of its loader, in base 88 and zstd; the loader unpacks it and adds it to the page
as one more inline script, so its hash is needed as well.
"""

import base64
import hashlib
import re
from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np
import viser
import zstandard
from numpy.typing import NDArray

from hexapods import assets

OFFLINE_SCRIPTS = (
    "client.js",
    "framed.js",
    "robots.js",
    "shots.js",
    "camera.js",
    "light.js",
    "shadows.js",
    "labels.js",
)
"""The scripts of the client in a page that is a file, which has it in a frame."""
_HEAD = "<head>"
_TITLE = "<title>Viser</title>"
_SCRIPT = re.compile(r"<script(?P<attributes>[^>]*)>(?P<body>.*?)</script>", re.DOTALL)
_PACKED = re.compile(
    r' data-p="(?P<packed>[^"&]+)" data-ss="(?P<style>\d+)" data-cs="(?P<code>\d+)"'
)
_ALPHABET = (
    b"!#$%()*+,-./0123456789:;=?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_abcdefghijklmnopqrstuvwxyz{|}~"
)
_MAX_BYTES = 64 << 20


def batch_colors(colors: NDArray[np.uint8], brightness: float = 1.0) -> NDArray[np.uint8]:
    """Convert sRGB to the linear colours that viser's client expects for batched meshes.

    Args:
        colors: (n, 3), 0–255.
        brightness: factor below 1 for surfaces that face the lamp and would look too pale.
    """
    return (255 * brightness * (colors / 255.0) ** 2.2).round().astype(np.uint8)


def content_policy(page: str, *, file_nonce: str | None = None) -> str:
    """Return the page's Content-Security-Policy.

    Besides scripts it allows what viser's client needs: it compiles WebAssembly, starts a worker
    made from a blob, sets styles from scripts, and loads textures as blobs. Nothing is loaded from
    a server: what is drawn comes from the page around it, or is in the file.

    Args:
        page: the page's HTML, patch included.
        file_nonce: nonce of the element that imports the modules of a page that is a file without
            a server. Such a page may be embedded anywhere.

    Raises:
        RuntimeError: This version of viser packs its client in another way.
    """
    ancestors = "; frame-ancestors 'self'"
    scripts = [_hash(script) for script in page_scripts(page)]
    if file_nonce is not None:
        ancestors = ""
        scripts.append(f"'nonce-{file_nonce}'")
    return (
        f"default-src 'none'; script-src 'strict-dynamic' 'wasm-unsafe-eval' {' '.join(scripts)}; "
        f"worker-src blob:; style-src 'unsafe-inline'; img-src blob: data:; "
        f"connect-src blob: data:; base-uri 'none'; form-action 'none'{ancestors}"
    )


def page_scripts(page: str) -> list[bytes]:
    """Return every script that is to run, the packed one last.

    Raises:
        RuntimeError: This version of viser packs its client in another way.
    """
    scripts = list(_SCRIPT.finditer(page))
    packed = [match for script in scripts if (match := _PACKED.fullmatch(script["attributes"]))]
    if len(packed) != 1:
        raise _unsupported(f"of {len(scripts)} scripts {len(packed)} hold the client, not one")
    return [*(script["body"].encode() for script in scripts), _unpacked(packed[0])]


def patched_page(title: str, scripts: Sequence[str], head: str = "") -> str:
    """Return viser's page with its patch: HTML without a policy.

    Args:
        title: of the page, plain text.
        scripts: names of files in `static/viewer`, which run before the client in this order.
        head: HTML that follows them.

    Raises:
        RuntimeError: The installed viser's page does not have the expected form.
    """
    html = (Path(viser.__file__).parent / "client" / "build" / "index.html").read_text("utf-8")
    if html.count(_HEAD) != 1 or html.count(_TITLE) != 1:
        raise _unsupported("its head or title is not where the patch goes")
    folder = assets.static_dir() / "viewer"
    # Read as they are sent, since the policy has the scripts' hashes.
    texts = [(folder / name).read_text("utf-8") for name in scripts]
    style = (folder / "patch.css").read_text("utf-8")
    patch = "".join(f"<script>{text}</script>" for text in texts) + f"<style>{style}</style>"
    html = html.replace(_TITLE, f"<title>{escape(title)}</title>")
    # At the start of the head, since viser's loader runs while the page is still parsed.
    return html.replace(_HEAD, f"{_HEAD}{patch}{head}")


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
    last_word = int(remainder @ 88 ** np.arange(len(remainder))[::-1])
    head: bytes = words.astype(">u4").tobytes()
    return head + last_word.to_bytes(max(0, len(remainder) - 1), "big")


def _hash(script: bytes) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(script).digest()).decode()}'"


def _unsupported(reason: str) -> RuntimeError:
    return RuntimeError(f"viser {viser.__version__} has another page than was expected: {reason}")
