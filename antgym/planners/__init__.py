"""How a path is found: parameters, rules, and the colony, the sole caller of the ant kernels."""
