"""Helpers that launch files import."""
