"""How a path is found: parameters, rules, and the colony; nobody above calls the ant kernels."""
