"""Whether loops over scalar laws are compiled to packed instructions."""

import platform
import re

# Packed products and sums, divisions, and square roots of float64 by the machine's architecture.
_X86 = {"product": r"\bvfn?m(add|sub)\d+pd\b", "quotient": r"\bv?divpd\b", "root": r"\bv?sqrtpd\b"}
PACKED = {
    "x86_64": _X86,
    "AMD64": _X86,
    "aarch64": {"product": r"\bfml[as]\W+v\d+\.2d", "quotient": r"\bfdiv\W+v\d+\.2d", "root": r"\bfsqrt\W+v\d+\.2d"},
    "arm64": {"product": r"\bfml[as]\.2d", "quotient": r"\bfdiv\.2d", "root": r"\bfsqrt\.2d"},
}
LIBRARY = r"\bcall\w*\s+\W*(exp|expm1|log|pow|sin|cos|a?tan2?|asin|fma|floor)\b"


def assert_packed(function, loops, operations=("product", "quotient")):
    """All of so many loops of a compiled function, or its assembly, are packed, and call no library."""
    assembly = function if isinstance(function, str) else "\n".join(function.inspect_asm().values())
    for operation in operations if platform.machine() in PACKED else ():
        pattern = PACKED[platform.machine()][operation]
        assert len(re.findall(pattern, assembly)) >= loops, pattern
    assert not re.search(LIBRARY, assembly)
