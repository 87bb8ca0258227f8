"""From scores of checks and points of persons to results."""
