"""Checksums of a result file's blocks and texts."""

import struct
import zlib
from collections.abc import Iterable, Mapping

import numpy as np

# Written at the end, in place.
CHANGING = ("finished", "outcome")


def checksum(block: int, arrays: Iterable[np.ndarray]) -> int:
    """CRC-32 of a block's arrays in sequence; it depends on the block number.

    Parameters
    ----------
    block : int
        Number of the block.
    arrays : iterable of ndarray
    """
    crc = zlib.crc32(struct.pack("<q", block))
    for array in arrays:
        crc = zlib.crc32(np.ascontiguousarray(array), crc)
    return crc


def texts_checksums(texts: Mapping[str, object]) -> dict[str, int]:
    """CRC-32 of each constant text attribute by name.

    Parameters
    ----------
    texts : mapping of str to object
    """
    kept = {name: text for name, text in texts.items() if isinstance(text, str) and name not in CHANGING}
    return {name: zlib.crc32(text.encode(errors="surrogatepass")) for name, text in kept.items()}
