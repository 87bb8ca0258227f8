"""The types of message fields, which `SLOT_TYPES` contains."""
