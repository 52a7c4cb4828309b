"""Generates evod/lab.py, the synchronous module, from evod/aio/lab.py.

    generate_sync.py SOURCE TARGET

Removes `async`, `await`, the parentheses around an awaited call, and everything imported from evod.aio.awaitable. Replaces
evod.aio.X by evod.X, and method names such as `__aiter__` by their synchronous names. Changes the examples in docstrings in
the same way.
"""
import io
import keyword
import pathlib
import re
import sys
import tokenize

NAMES = {
    "__aenter__": "__enter__", "__aexit__": "__exit__", "__aiter__": "__iter__", "__anext__": "__next__", "anext": "next",
    "StopAsyncIteration": "StopIteration", "AsyncIterator": "Iterator",
}
DECORATORS = ("opens", "opens_stream")


def without_async(text):
    """Converts the text of a docstring or comment."""
    text = re.sub(r"\basync (?=with|for\b)", "", text)
    text = re.sub(r"\bawait ", "", text)
    return text.replace("evod.aio", "evod")


def synchronous(source):
    """Returns the source of the synchronous module with the same classes and functions."""
    lines = source.splitlines(keepends=True)
    lines = [line for line in lines if line.strip() not in {f"@{name}" for name in DECORATORS}
             and not line.startswith("from evod.aio.awaitable import ")]
    source = "".join(lines).replace("evod.aio.", "evod.")
    tokens = list(tokenize.generate_tokens(io.StringIO(source).readline))
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def offset(place):
        return starts[place[0] - 1] + place[1]

    edits = []  # changes of the source: (begin, end, replacement)
    grouping = []  # for each open bracket: whether it is a parenthesis around an awaited call
    for i, token in enumerate(tokens):
        begin, end = offset(token.start), offset(token.end)
        if token.string in ("(", "[", "{") and token.type == tokenize.OP:
            before, after = tokens[i - 1], tokens[i + 1]
            is_call = before.string in (")", "]") or before.type == tokenize.NAME and not keyword.iskeyword(before.string)
            grouping.append(token.string == "(" and not is_call and after.string == "await")
            if grouping[-1]:
                edits.append((begin, end, ""))
        elif token.string in (")", "]", "}") and token.type == tokenize.OP:
            if grouping.pop():
                edits.append((begin, end, ""))
        elif token.type == tokenize.NAME and token.string in ("async", "await"):
            edits.append((begin, offset(tokens[i + 1].start), ""))
        elif token.type == tokenize.NAME and token.string in NAMES:
            edits.append((begin, end, NAMES[token.string]))
        elif token.type in (tokenize.STRING, tokenize.COMMENT):
            edits.append((begin, end, without_async(token.string)))
    for begin, end, replacement in reversed(edits):
        source = source[:begin] + replacement + source[end:]
    return source


def main(source, target):
    text = synchronous(pathlib.Path(source).read_text())
    head = '"""Labs, worlds and streams; every call waits for its answer. Generated from aio/lab.py by generate_sync.py.\n\n' \
           'Threads      any number of threads may use one Lab at the same time.\n"""\n'
    pathlib.Path(target).write_text(head + text[text.index('"""', 3) + 4:])


if __name__ == "__main__":
    main(*sys.argv[1:])
