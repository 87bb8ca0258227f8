"""Start JupyterLab as `python -m jupyterlab` does, but in half the time."""

import sys

# jsonschema would compile 38 grammars of internationalized addresses, which takes 2 s. No schema of
# Jupyter or of its notebooks contains such an address.
sys.modules["rfc3987_syntax"] = None  # type: ignore[assignment]  # an import raises ImportError


def kernel_options() -> list[str]:
    """Return options that encrypt the messages of kernels, where Jupyter and libzmq support it.

    Recent versions of ipykernel warn in the terminal of `course lab`, below the address that
    students open, if there is no encryption. Older servers report the option itself as unknown.
    """
    import zmq
    from jupyter_server.services.kernels.kernelmanager import MappingKernelManager

    has_option = "transport_encryption" in MappingKernelManager.class_trait_names()
    return ["--MappingKernelManager.transport_encryption=auto"] if has_option and zmq.has("curve") else []


def skip_yarn() -> None:
    """Skip JupyterLab's query of yarn's configuration, which takes a second where Node.js is installed.

    The configuration contains the package registry from which JupyterLab would rebuild itself.
    """
    from jupyterlab import commands

    commands._yarn_config = lambda _: {"yarn config": {}, "npm config": {}}


if __name__ == "__main__":
    # Called first, because importing jupyterlab.labapp already queries yarn.
    skip_yarn()
    from jupyterlab.labapp import main

    sys.exit(main([*sys.argv[1:], *kernel_options()]))
