"""Tests in namespaces of their own: networks and mounts that vanish with the test.

Root may make them, and so may every user where the system lets him be root in a namespace. Many containers allow
neither: the test is skipped there, with status 77, ctest's SKIP_RETURN_CODE.
"""
import os
import subprocess
import sys

SKIPPED = 77


def enter(kinds, trial, what):
    """Starts this program again as root in namespaces of its own; returns in that second one.

    kinds  options of unshare
    trial  a command that has to succeed there
    what   what cannot be done where it fails
    """
    if os.environ.get("NAMESPACES") == "own":
        return
    unshare = ["unshare", "--user", "--map-root-user", *kinds]
    try:
        tried = subprocess.run([*unshare, *trial], capture_output=True, text=True)
        reason = tried.stderr.strip() if tried.returncode != 0 else None
    except FileNotFoundError as missing:
        reason = str(missing)
    if reason is not None:
        print(f"skipped: {what}: {reason}")
        sys.exit(SKIPPED)
    os.execvpe(unshare[0], [*unshare, sys.executable, *sys.argv], {**os.environ, "NAMESPACES": "own"})
