"""Start JupyterLab as `python -m jupyterlab` does, but in half the time."""

import sys

# jsonschema would compile 38 grammars of internationalized addresses, which takes 2 s. No schema of
# Jupyter or of its notebooks contains such an address.
sys.modules["rfc3987_syntax"] = None  # type: ignore[assignment]  # an import raises ImportError

if __name__ == "__main__":
    from jupyterlab.labapp import main

    sys.exit(main())
