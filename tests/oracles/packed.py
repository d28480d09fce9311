"""Whether loops over scalar laws are compiled to packed instructions."""

import platform
import re

# Packed products and sums, and divisions, of float64 by the machine's architecture.
PACKED = {
    "x86_64": (r"\bvfn?m(add|sub)\d+pd\b", r"\bvdivpd\b"),
    "AMD64": (r"\bvfn?m(add|sub)\d+pd\b", r"\bvdivpd\b"),
    "aarch64": (r"\bfml[as]\W+v\d+\.2d", r"\bfdiv\W+v\d+\.2d"),
    "arm64": (r"\bfml[as]\.2d", r"\bfdiv\.2d"),
}
LIBRARY = r"\bcall\w*\s+\W*(exp|expm1|log|pow|sin|cos|a?tan2?|asin|fma|floor)\b"


def assert_packed(function, loops):
    """Of a compiled function with so many loops over laws that divide: all are packed, and call no library."""
    assembly = "\n".join(function.inspect_asm().values())
    for pattern in PACKED.get(platform.machine(), ()):
        assert len(re.findall(pattern, assembly)) >= loops, pattern
    assert not re.search(LIBRARY, assembly)
