"""What launch files say about nodes; the kit's stand-in."""
