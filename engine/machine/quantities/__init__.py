"""The register of quantities: what may be asked, in words and units."""
