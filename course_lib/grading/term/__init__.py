"""A term: the class list, weights, groups, totals, and requests to look again."""
