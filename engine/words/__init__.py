"""Engineers' synonyms, descriptions of quantities, and verdicts on variants."""
