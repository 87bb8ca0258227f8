"""The time that tests wait for a state that must come: two servers take 60 s to start on two busy cores."""

PATIENCE = 120.0  # [s]
