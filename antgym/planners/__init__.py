"""How a path is found: parameters, rules, the colony and the hive; nobody above calls their kernels."""
