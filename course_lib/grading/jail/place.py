"""The place where submissions run: a root with readable files, a user, and a scratch folder."""

import os
from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Literal

from course_lib.grading.jail import namespaces
from course_lib.grading.jail.system_calls import KEEP_CAPABILITIES, drop_capabilities, prctl, use_capabilities

Root = Literal["own", "bubblewrap", "host"]
User = Literal["another", "real", "same"]
INSIDE = "/submission/home"  # the scratch folder in a root of its own
HOMES = ("HOME", "TMPDIR", "IPYTHONDIR", "MPLCONFIGDIR")
DEVICES = ("/dev/null", "/dev/zero", "/dev/urandom", "/dev/random")
FIRST_USER, USERS = 61184, 4336  # what systemd gives to services for a while: nobody's files


@dataclass(frozen=True)
class Place:
    """The root, the user and the folders of submissions.

    Args:
        root: A new one, that of bubblewrap, or that of the machine.
        user: One that has no files; or the same that counts as another; or the same.
        number: Of that user, if it is another one.
        scratch: The folder that they may write in.
        read: Files and folders that they may read.
        listed: Folders of which they may read the names.
    """

    root: Root
    user: User
    number: int
    scratch: str
    read: tuple[str, ...]
    listed: tuple[str, ...] = ()

    @property
    def owner(self) -> int:
        """The owner of files that submissions write."""
        return self.number if self.user == "another" else os.geteuid()


def settle(
    roots: Collection[Root], users: Sequence[User], scratch: str, read: Sequence[str], listed: Sequence[str],
    links: Sequence[tuple[str, str]],
) -> Place:  # fmt: skip
    """Move this process to the first place that works; each is tried in a fork.

    Args:
        roots: Which are good enough, the best first.
        users: In the same order.
        scratch: An empty folder; taken away with a root that has its own.
        read: Files and folders that submissions may read.
        listed: Folders of which they may read the names.
        links: Symbolic links that a new root needs.

    Raises:
        OSError: None works.
    """
    number = FIRST_USER + os.getpid() % USERS
    for root in roots:
        for user in users:
            has_own = root == "own"
            tops = sorted({"/" + path.split("/")[1] for path in read})  # all of it is readable
            folder, kept = (INSIDE, tops) if has_own else (scratch, read)
            place = Place(root, user, number, folder, tuple(kept), tuple(listed))
            if works(lambda place=place: _try(place, read, links)):  # type: ignore[misc]  # bound at once
                if has_own:
                    os.rmdir(scratch)
                _move(place, read, links)
                os.environ.update(dict.fromkeys(HOMES, place.scratch))
                return place
    raise OSError("no place for submissions")


def works(layer: Callable[[], object]) -> bool:
    """Return whether a call, which may fork, comes to its end in a fork; one that is killed is repeated."""
    return (_tried(layer) or _tried(layer)) == b"y"


def _tried(layer: Callable[[], object]) -> bytes:
    """Return b"y" if a call comes to its end in a fork of this process, b"n" if not, b"" if it is killed."""
    reader, writer = os.pipe()
    pid = os.fork()
    if pid == 0:
        with suppress(BaseException):
            layer()
            os.write(writer, b"y")
            os._exit(0)
        os.write(writer, b"n")
        os._exit(0)
    os.close(writer)
    said = os.read(reader, 1)  # from its fork, if it has one
    os.close(reader)
    os.waitpid(pid, 0)
    return said


def _move(place: Place, read: Sequence[str], links: Sequence[tuple[str, str]]) -> None:
    if place.root == "host":
        os.chown(place.scratch, place.owner, -1)
    if place.user != "same":
        _become_another(place)
    if place.root == "own":
        shown = [*read, *filter(os.path.exists, DEVICES)]
        namespaces.own_root(shown, place.listed, links, place.scratch)


def _try(place: Place, read: Sequence[str], links: Sequence[tuple[str, str]]) -> None:
    _move(place, read, links)
    if place.user != "same":
        drop_capabilities()
        unreadable = [path for path in read if not os.access(path, os.R_OK, effective_ids=True)]
        if unreadable:
            raise OSError(f"another user can't read {unreadable[0]}")


def _become_another(place: Place) -> None:
    """Change the user, and keep what root may do for what is still to be built."""
    user = place.number
    if place.user == "real":  # owner of the files as before; the kernel counts processes of the real user
        os.setresuid(user, -1, -1)
        return
    prctl(KEEP_CAPABILITIES, 1)
    os.setgroups([])
    os.setresgid(user, user, user)
    os.setresuid(user, user, user)
    use_capabilities()
