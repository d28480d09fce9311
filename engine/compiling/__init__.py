"""Compilation: floating-point rules, decorators, the cache of machine code, threads."""
