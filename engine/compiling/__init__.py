"""How the mechanics is compiled: floating-point rules, the cache of machine code, threads."""
