"""The implementation of the public modules."""
