"""The page in the browser on which persons mark."""
