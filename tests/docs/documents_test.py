"""Runs a document as its reader would: what stands in its blocks, in their order, in a fresh folder.

    documents_test.py DOCUMENT [-v]      skipped with status 77 where no network of its own may be made

The folder looks like that of the sources, and build/release in it is the environment's BUILD, whose programs are on the
path and whose Python package can be imported. HOME is above it, and the network is the document's own, so that every
port is free and nothing comes from outside; as root there the test can mount folders in a namespace of its own.

    ```sh       all of them are run by one bash, so variables, folders and servers in the background stay.
                Every command has to succeed.
    ```python   a program of its own, in the folder that bash is in
    ```sql      what sqlite3 is asked, of default.evod in that folder; each question has to have an answer
    ```text     what the block before it prints, on both outputs together. A line of … stands for any lines, or none

Other blocks are not run. HTML comments before a block, which readers of the page do not see, say more about it:

    <!-- not run: REASON -->       it needs what a test lacks: root, a window, a person. They are counted and printed
    <!-- ends with status N -->    that is what its last command is for
    <!-- before: CODE -->          goes before it, in its language, of sql in sh: what its reader has done
    <!-- varies: REGEX -->         of a ```text: each match stands for any other, as evod's version does; the rest is
                                   compared letter by letter
"""
import collections
import contextlib
import dataclasses
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "system"))
import namespaces  # noqa: E402
import waiting  # noqa: E402

LANGUAGES = {"sh", "python", "sql", "text"}
VERSION = r"(?<=evod )\d+\.\d+\.\d+"
ROOT = pathlib.Path(__file__).resolve().parents[2]


class Wrong(Exception):
    """What is wrong with a document, or with what its blocks did."""


@dataclasses.dataclass
class Block:
    language: str
    line: int  # of its first line, from 1
    text: str
    marks: dict


RUN = re.compile(r"^\s*```(?:sh|python|sql|text)\b", re.M)
PARTS = re.compile(r"^<!--\s*(?P<mark>not run|ends with status|before|varies):?\s+(?P<value>.*?)\s*-->$"
                   r"|^```(?P<language>\w+)\n(?P<text>.*?)^```$"
                   r"|^```\n.*?^```$", re.M | re.S)
FOR = {"not run": {"sh", "python", "sql"}, "ends with status": {"sh"}, "before": {"sh", "python", "sql"},
       "varies": {"text"}}


def blocks_of(document):
    """Those that are run or compared, in order, each with its marks."""
    blocks, marks = [], {}
    for part in PARTS.finditer(document):
        line = document.count("\n", 0, part.start()) + 1
        if part["mark"]:
            marks[part["mark"]] = part["value"]
            continue
        if part["language"] in LANGUAGES:
            blocks.append(Block(part["language"], line + 1, part["text"], marks))
        elif marks:
            raise Wrong(f"line {line}: a block that is not run has marks: {marks}")
        for mark in marks:
            if part["language"] not in FOR[mark]:
                raise Wrong(f"line {line}: '{mark}' says nothing of a block of {part['language']}")
        marks = {}
    if marks:
        raise Wrong(f"no block after the marks {marks}")
    if len(blocks) != len(RUN.findall(document)):
        raise Wrong("some blocks are not found: they begin in the first column and end with ``` alone on a line")
    return blocks


def pattern(shown, varies):
    """A regular expression for what a document shows."""
    varies = "|".join([*([varies] if varies else []), VERSION])
    lines = []
    for line in shown.splitlines():
        if line.strip() == "…":
            lines.append(r"(?:[^\n]*\n)*?")
            continue
        exact, end = "", 0
        for match in re.finditer(varies, line):
            exact += re.escape(line[end:match.start()]) + f"(?:{varies})"
            end = match.end()
        lines.append(exact + re.escape(line[end:]) + r"[ ]*\n")
    return re.compile("".join(lines))


class Reader:
    """A bash that does as the document says."""

    def __init__(self, folder):
        self.scratch, self.home = folder, folder / "home"
        work = self.home / "evod"
        (work / "build").mkdir(parents=True)
        for name in "CMakeLists.txt", "VERSION", "experiments", "scripts", "proto":
            (work / name).symlink_to(ROOT / name)
        made = shutil.ignore_patterns("__pycache__", "build", "*.egg-info")
        shutil.copytree(ROOT / "client/python", work / "client/python", ignore=made)
        (work / "build/release").symlink_to(os.environ["BUILD"])
        environment = {"PATH": os.environ["BUILD"] + "/bin:/usr/bin:/bin:/usr/sbin:/sbin", "HOME": str(self.home),
                       "PYTHONPATH": os.environ["BUILD"] + "/python", "LC_ALL": "C.UTF-8", "TZ": "UTC",
                       "TMPDIR": str(folder),
                       "MPLBACKEND": "Agg", "MPLCONFIGDIR": os.environ["BUILD"] + "/matplotlib"}
        # the search for fonts prints a warning if it takes long, so it is done here
        if not pathlib.Path(environment["MPLCONFIGDIR"]).exists():
            subprocess.run(["/usr/bin/python3", "-c", "import matplotlib.font_manager"], env=environment,
                           capture_output=True)
        self.bash = subprocess.Popen(["bash", "--norc", "--noprofile"], cwd=work, env=environment, umask=0o022,
                                     start_new_session=True, text=True, stdin=subprocess.PIPE,
                                     stdout=subprocess.DEVNULL,
                                     stderr=subprocess.DEVNULL)
        self.count = 0

    def close(self):
        """Nothing that a block began outlives its document."""
        # a bash in which a command failed has ended, perhaps with all others
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.bash.pid, signal.SIGKILL)
        self.bash.communicate()

    def in_background(self):
        return set(pathlib.Path(f"/proc/{self.bash.pid}/task/{self.bash.pid}/children").read_text().split())

    def more_may_come(self):
        """Whether what the last block began still runs."""
        return bool(self.in_background() - self.before)

    def run(self, block):
        """Runs the block to its end; returns the file with what it says, to which its servers go on writing."""
        code, status = block.text, int(block.marks.get("ends with status", 0))
        if block.language == "sql":
            code = "\n".join(f"sqlite3 -readonly default.evod <<'SQL' | grep ''\n{question};\nSQL"
                             for question in code.split(";")[:-1])
        self.count += 1
        program, said, ended = (self.scratch / f"{self.count}.{part}" for part in ("program", "said", "ended"))
        program.write_text(block.marks.get("before", "") + "\n" + code)
        if block.language == "python":
            how = f'PYTHONPATH="$PWD:$PYTHONPATH" /usr/bin/python3 {program}'
        else:
            how = f"set -o pipefail {'+e' if status else '-e'}; . {program}"
        self.before = self.in_background()
        self.bash.stdin.write(
            f"{how} >{said} 2>&1 </dev/null; echo $? >{ended}.part; set +e; mv {ended}.part {ended}\n")
        self.bash.stdin.flush()
        try:
            waiting.until(lambda: ended.exists() or self.bash.poll() is not None, "the end of the block",
                          longest_s=math.inf)
        except AssertionError as wrong:
            raise Wrong(f"{wrong}; it said\n{said.read_text(errors='replace')}") from None
        got = int(ended.read_text()) if ended.exists() else self.bash.returncode
        if got != status:
            raise Wrong(f"ended with status {got}, not {status}; it said\n{said.read_text(errors='replace')}")
        return said


def compare(block, said, more_may_come):
    """Waits until the output is what the document shows: what runs in the background may be slower than who started
    it."""
    expected = pattern(block.text, block.marks.get("varies"))
    matched, text = None, ""

    def settled():
        nonlocal matched, text
        final = not more_may_come()
        text = said.read_text(errors="replace")
        matched = expected.fullmatch(text.replace(" (slower)", ""))  # what a busy machine adds to a speed
        return matched or final
    with contextlib.suppress(AssertionError):
        waiting.until(settled, "the output", pause_s=0.02)
    if not matched:
        raise Wrong(f"shown is\n{block.text}\nsaid was\n{text}")


def read(path, reader, verbose):
    """Follows the document; returns the report."""
    counts, left_out, said = collections.Counter(), collections.Counter(), None
    for block in blocks_of(path.read_text()):
        begun = time.monotonic()
        try:
            if block.language == "text":
                if said is None:
                    raise Wrong("nothing was run whose output this could be")
                compare(block, said, reader.more_may_come)
                said = None
                counts["outputs compared"] += 1
            elif "not run" in block.marks:
                said = None
                left_out[block.marks["not run"]] += 1
            else:
                said = reader.run(block)
                counts[block.language + " blocks"] += 1
        except Wrong as wrong:
            raise Wrong(f"{path.name}, line {block.line}: {wrong}") from None
        if verbose:
            print(f"line {block.line}: {block.language}, {time.monotonic() - begun:.2f} s")
            if said:
                print(said.read_text(errors="replace"))
    return ([f"{count} {what}" for what, count in counts.items()] +
            [f"{count} not run: {reason}" for reason, count in left_out.items()]) or ["nothing to run"]


def main():
    namespaces.enter(["--net", "--mount"], ["ip", "link", "set", "lo", "up"],
                     "no network of its own may be made here, or there is no ip (Debian's package iproute2)")
    subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
    path = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        reader = Reader(pathlib.Path(folder))
        try:
            print("\n".join(read(path, reader, "-v" in sys.argv)))
        except Wrong as wrong:
            sys.exit(str(wrong))
        finally:
            reader.close()


if __name__ == "__main__":
    main()
