"""Writing of files that are complete or unchanged, whatever ends the program."""

import os
from contextlib import suppress
from functools import partial
from pathlib import Path


def write_atomically(path: Path, data: bytes, mode: int = 0o666) -> None:
    """Write a file so that it is complete or unchanged. Its folder is created if it is missing.

    The content is written to a draft next to the file and synchronized to the disk, then the draft
    is renamed.

    Args:
        path: The file.
        data: The whole content.
        mode: Its permissions, reduced by the umask.

    Raises:
        OSError: The file cannot be written. The error contains its path, not the draft's.
    """
    draft = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # A leftover draft may have different permissions.
        draft.unlink(missing_ok=True)
        with open(draft, "wb", opener=partial(os.open, mode=mode)) as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        draft.replace(path)
    except BaseException as error:
        # On a full disk, a partial draft would take up space.
        with suppress(OSError):
            draft.unlink()
        if isinstance(error, OSError):
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise
