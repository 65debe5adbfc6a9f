"""PNG files, written with what Python has."""

from __future__ import annotations

import struct
import zlib
from typing import Final

import numpy as np
from numpy.typing import NDArray

Pixels = NDArray[np.uint8]

_COLOUR_TYPES: Final = {3: 2, 4: 6}  # channels → the code of the file


def png_bytes(pixels: Pixels) -> bytes:
    """Return a PNG of pixels (rows from above, columns, RGB or RGBA)."""
    height, width, channels = pixels.shape
    lines = pixels.reshape(height, -1)
    # Each row as what differs from the row above it (filter 2): shades run on.
    above = np.zeros_like(lines)
    above[1:] = lines[:-1]
    rows = np.concatenate([np.full((height, 1), 2, dtype=np.uint8), lines - above], axis=1)

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = struct.pack(">IIBBBBB", width, height, 8, _COLOUR_TYPES[channels], 0, 0, 0)
    body = zlib.compress(rows.tobytes(), 9)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", body) + chunk(b"IEND", b"")
