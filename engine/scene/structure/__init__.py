"""The structure of a mechanism: input link, dyads, and the groups that free links make up."""
