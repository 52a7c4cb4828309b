"""Makes the message classes of evod.v1 with protoc, and version.py, while the package is built; pyproject.toml tells all
else.

They are made from the proto folder of evod's sources. $PROTOC names another protoc than the one on the path.
"""
import os
import pathlib
import re
import shutil
import subprocess

import setuptools
from setuptools.command.build_py import build_py

here = pathlib.Path(__file__).resolve().parent
sources = here.parent.parent


class BuildWithMessages(build_py):
    def run(self) -> None:
        super().run()
        folder = here if self.editable_mode else pathlib.Path(self.build_lib)
        make_messages(folder)
        (folder / "evod" / "version.py").write_text(f'"""Made by setup.py."""\n__version__ = "{version()}"\n')


def make_messages(folder: pathlib.Path) -> None:
    """Writes evod/v1/*_pb2.py, and what type checkers read of them, into the folder."""
    protos = sorted((sources / "proto" / "evod" / "v1").glob("*.proto"))
    if not protos:
        raise SystemExit(f"there are no messages in {sources / 'proto'}: build this package within evod's sources")
    protoc = os.environ.get("PROTOC") or shutil.which("protoc")
    if not protoc:
        raise SystemExit("protoc is missing: install protobuf-compiler, or name one in $PROTOC")
    (folder / "evod" / "v1").mkdir(parents=True, exist_ok=True)
    subprocess.run([protoc, f"--proto_path={sources / 'proto'}", f"--python_out={folder}", f"--pyi_out={folder}",
                    *map(str, protos)], check=True)
    (folder / "evod" / "v1" / "__init__.py").write_text(
        '"""The messages of evod\'s protocol, made by protoc; docs/PROTOCOL.md tells what they mean."""\n')


def version() -> str:
    """That of evod itself."""
    found = re.search(r"project\(evod\s+VERSION\s+([0-9.]+)", (sources / "CMakeLists.txt").read_text())
    if not found:
        raise SystemExit(f"{sources / 'CMakeLists.txt'} does not tell evod's version")
    return found[1]


setuptools.setup(version=version(), cmdclass={"build_py": BuildWithMessages})
