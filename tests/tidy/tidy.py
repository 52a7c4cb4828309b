"""Rules of style that a program can check: plain words, braces, whole comment blocks, short test names, header pages,
sizes, names that Python defines twice or never uses, unit tests.

    tidy.py [ROOT]     prints every finding as PATH:LINE: what is wrong, and what to write instead

Reads the files that git tracks below ROOT, by default this repository. Exit code 1 if there is a finding.
"""
import ast
import pathlib
import re
import subprocess
import sys

TEST_NAME_CHARACTERS_MAX = 50
SOURCE_LINES_MAX = 700
FUNCTION_LINES_MAX = 100  # without the docstring
COLUMNS_MAX = 120

# Files that exceed a limit → why.
LARGER_FILES = {
    "tests/system/viewer/panels_test.cpp": "to be cut by its panels",
}
WIDER_FILES = {
    "server/evolution/ga_parameters.h": "a parameter is one line",
    "server/parameters/model_parameters.h": "a parameter is one line",
}
LARGER_FUNCTIONS = {
    "tests/determinism/scenarios.cpp": "a table, which a function initialises at its first call",
}

# Word → what to write instead. A word is found in comments, texts and documents, and as a part of a name: `told` is
# found in `told_count` and in `ToldCount`.
BANNED = {
    "picture": "snapshot (streamed or in memory), frame (drawn on the screen), image or plot (a file)",
    "pictures": "snapshots, frames, images or plots",
    "pictured": "shown or captured",
    "tell": "the exact verb: encode, send, report, print, return, distinguish",
    "tells": "the exact verb: encodes, sends, reports, prints, returns, distinguishes",
    "told": "the exact verb: encoded, sent, reported, printed, returned, informed",
    "telling": "the exact verb",
    "untold": "not reported",
    "whoever": "name the thread, client or caller",
    "whomever": "name the thread, client or caller",
    "nobody": "name who: no client, no viewer, no organism",
    "somebody": "name who: a client, a viewer, a caller",
    "anew": "again, or from the start",
    "foretold": "predicted",
    "foretell": "predict",
    "foretells": "predicts",
    "footing": "baseline",
    "footings": "baselines",
    "journey": "seek",
    "journeys": "seeks",
}
# Names from the time before the glossary, which have an ordinary meaning as words: only as a whole name.
BANNED_NAMES = {
    "Retries": "ReplyCache", "Pulse": "Heartbeat", "Buffers": "SendMemory", "Breedings": "BackgroundQueries",
    "Rearranging": "OrderMutation", "Sight": "Perception or ViewOptions",
    "Scene": "QuantisedSnapshot or IslandRenderer",
    "Chain": "DeltaStream", "Watch": "WorldFeed or StreamDemand", "Thinning": "Retention", "Inquiry": "Poll",
    "Readout": "StatusText",
}
CODE = (".cpp", ".h", ".c", ".proto", ".py")
TEXT = (*CODE, ".ts", ".glsl", ".mjs", ".css", ".html", ".md", ".txt", ".in", ".cmake", ".sh", ".json", ".yaml",
        ".toml", "")
# The changelog names what was renamed, and this test names what is banned. The rest is not ours to write, or not text.
WITHOUT_WORDS = re.compile(r"CHANGELOG\.md|LICENSE|tests/tidy/|tests/fuzz/corpus/|proto/vectors/|\.gitignore")

TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)
                       |(?P<text>R"(?P<mark>\w*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*')
                       |(?P<word>[A-Za-z_]\w*)|(?P<other>\S)""", re.S | re.X)


def line_of(text, offset):
    """The number of the line, from 1, in which an offset lies."""
    return text.count("\n", 0, offset) + 1


def tokens_of(text):
    """(kind, token, line) of C++ or Protocol Buffers, without comments and preprocessor lines."""
    text = re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", lambda found: "\n" * found.group().count("\n"), text, flags=re.M)
    line, end = 1, 0
    for found in TOKEN.finditer(text):
        line += text.count("\n", end, found.start())
        end = found.start()
        if found.lastgroup != "comment":
            yield found.lastgroup, found.group(), line


# Words that a file may contain: names that users know and that therefore stay.
EXCEPTIONS = {
    "server/commands/compare.cpp": {"picture"},  # the older name of the option --plot
    "tests/system/compare_test.py": {"picture"},
}


def words_of(name):
    """The words of a snake_case or CamelCase name, in lower case."""
    return [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", name)]


def banned_words(path, text):
    """Words and names that the glossary replaces."""
    for number, line in enumerate(text.splitlines(), 1):
        for found in re.finditer(r"[A-Za-z_]+", line):
            name = found.group()
            for word in sorted((set(words_of(name)) & BANNED.keys()) - EXCEPTIONS.get(str(path), set())):
                yield path, number, f"`{name}`: instead of '{word}' write {BANNED[word]}"
            if name in BANNED_NAMES and path.suffix in CODE:
                yield path, number, f"`{name}`: the name is {BANNED_NAMES[name]}"


# "the output is no terminal", but not "there is no terminal" and "it is no longer there"
IS_NO = re.compile(r"(?<!\bthere )\b(is|are|was|were) no (?!longer\b|more\b|less\b)\w+", re.I)


def banned_grammar(path, text):
    """Sentences that say "is no X" for "is not a X"."""
    for number, line in enumerate(text.splitlines(), 1):
        for found in IS_NO.finditer(line):
            # a line may begin with the end of "there is no X"
            if re.search(r"\w", re.sub(r"^\s*(///?|\*|#)\s*", "", line[:found.start()])):
                yield path, number, f"`{found.group()}`: write '{found.group(1)} not' or 'there {found.group(1)} no'"


def missing_braces(path, text):
    """Statements after if, else, for, while and do that have no braces."""
    if path.suffix not in (".cpp", ".h"):
        return
    tokens = list(tokens_of(text))
    depth, do_depths = 0, []
    for i, (kind, token, line) in enumerate(tokens):
        if kind == "other" and token in "{}":
            depth += 1 if token == "{" else -1
        if kind != "word" or token not in ("if", "else", "for", "while", "do"):
            continue
        following = i + 1
        if token == "do":
            do_depths.append(depth)
        if token == "while" and do_depths and do_depths[-1] == depth and tokens[i - 1][1] == "}":
            do_depths.pop()
            continue
        if token in ("if", "for", "while"):
            while following < len(tokens) and tokens[following][1] in ("constexpr", "consteval"):
                following += 1
            if following >= len(tokens) or tokens[following][1] != "(":
                continue
            parentheses = 0
            while following < len(tokens):
                parentheses += {"(": 1, ")": -1}.get(tokens[following][1], 0)
                following += 1
                if parentheses == 0:
                    break
        if following < len(tokens) and tokens[following][1] not in ("{", "[") and not (
                token == "else" and tokens[following][1] == "if"):
            yield path, line, f"`{token}` without braces: write them, around one statement too"


def torn_comments(path, text):
    """Comment blocks whose lines a formatter has joined."""
    if not is_measured(path, text):
        return
    for number, line in enumerate(text.splitlines(), 1):
        if re.match(r"\s*(?://+|#)\s*[^\s/].*\s(Owner|Threads|Determinism|Source)\s{2,}\S", line):
            yield path, number, "a comment block is torn: begin Owner, Threads, Determinism and Source on own lines"


def long_test_names(path, text):
    """Names of tests that are too long to read in a list."""
    if not path.parts or path.parts[0] != "tests":
        return
    found = (re.finditer(r"^(?:TEST|TEST_F|TEST_P|TYPED_TEST|RC_GTEST_PROP|RC_GTEST_FIXTURE_PROP)\(\s*\w+,\s*(\w+)",
                         text, re.M)
             if path.suffix == ".cpp" else re.finditer(r"^\s*(?:async )?def test_(\w+)", text, re.M)
             if path.suffix == ".py" else ())
    for name in found:
        if len(name[1]) > TEST_NAME_CHARACTERS_MAX:
            yield (path, line_of(text, name.start()),
                   f"the test's name has {len(name[1])} characters, allowed {TEST_NAME_CHARACTERS_MAX}: claim it in "
                   "fewer words")


def header_without_page(path, text):
    """Headers that do not begin with what they are."""
    if path.suffix != ".h":
        return
    page = re.match(r"(?://[^\n]*\n)+", text)
    if not page or not re.match(r"// .{20,}", page.group()):
        yield path, 1, "the header begins without its page: what it is, owner, threads, determinism, source"


def is_measured(path, text):
    """Whether the limits of size hold for a file. They do not hold for generated files."""
    is_page = path.suffix == ".ts" and str(path).startswith("client/web/src/")
    if path.suffix not in (".cpp", ".h", ".py") and not is_page:
        return False
    return not re.search(r"^\W*(?:.*\. )?Generated by ", "\n".join(text.splitlines()[:5]), re.M)


def large_source(path, text):
    """Sources that hold more than one subject."""
    lines = text.count("\n")
    if is_measured(path, text) and lines > SOURCE_LINES_MAX and str(path) not in LARGER_FILES:
        yield path, 1, f"{lines} lines, allowed {SOURCE_LINES_MAX}: cut the source by its subjects"


def python_functions(text):
    """(name, first line, number of lines without the docstring) of every function."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            documented = node.body[0].end_lineno - node.body[0].lineno + 1 if ast.get_docstring(node) is not None else 0
            yield node.name, node.lineno, node.end_lineno - node.lineno + 1 - documented


def braced_functions(text):
    """(name, first line, number of lines) of every function of C++ or TypeScript that is not within another one."""
    tokens = list(tokens_of(text))
    scopes = []  # for each open brace: (kind, name, first line); kinds are "function", "member" and "other"
    begin = 0  # index of the first token of the current declaration
    for i, (_, token, line) in enumerate(tokens):
        if token == "{":
            head = [word for _, word, _ in tokens[begin:i]]
            opening = head.index("(") if "(" in head else 0
            after = head[len(head) - head[::-1].index(")"):] if ")" in head else head
            is_scope = {"namespace", "class", "struct", "enum"} & set(after)
            is_function = opening > 0 and "=" not in head[:opening] and not is_scope
            kind = "other"
            if is_function and ":" in head[opening:] and after and re.fullmatch(r"\w+_", head[-1]):
                kind = "member"  # `: member_{value}` of a constructor
            elif is_function and not any(of == "function" for of, _, _ in scopes):
                kind = "function"
            scopes.append((kind, head[opening - 1] if is_function else "", tokens[begin][2] if begin < i else line))
        elif token == "}" and scopes:
            kind, name, first = scopes.pop()
            if kind == "function":
                yield name, first, line - first + 1
        if token == ";" or token == "{" and scopes[-1][0] != "member" or token == "}" and kind != "member":
            begin = i + 1


def large_function(path, text):
    """Functions that do more than one thing."""
    if not is_measured(path, text) or str(path) in LARGER_FUNCTIONS:
        return
    for name, line, lines in python_functions(text) if path.suffix == ".py" else braced_functions(text):
        if lines > FUNCTION_LINES_MAX:
            yield path, line, f"`{name}` has {lines} lines, allowed {FUNCTION_LINES_MAX}: cut the function by its steps"


def long_line(path, text):
    """Lines that do not fit next to each other."""
    if not is_measured(path, text) or str(path) in WIDER_FILES:
        return
    for number, line in enumerate(text.splitlines(), 1):
        if len(line) > COLUMNS_MAX:
            yield path, number, f"{len(line)} columns, allowed {COLUMNS_MAX}: wrap the line"


def bound_names(statement):
    """The names that a statement of a module or a class binds: (name, whether it may replace an earlier one)."""
    if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
        decorators = {ast.unparse(decorator) for decorator in statement.decorator_list}
        if not any(one.endswith("overload") for one in decorators):  # the implementation follows
            yield statement.name, any(one.endswith((".setter", ".deleter", ".register")) for one in decorators)
    elif isinstance(statement, ast.AnnAssign):
        if isinstance(statement.target, ast.Name) and statement.value is not None:
            yield statement.target.id, False
    elif isinstance(statement, ast.Assign):
        for target in statement.targets:
            for node in ast.walk(target):
                if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                    reads_itself = any(isinstance(one, ast.Name) and one.id == node.id
                                       for one in ast.walk(statement.value))
                    yield node.id, reads_itself
    elif isinstance(statement, (ast.Import, ast.ImportFrom)):
        for imported in statement.names:
            yield imported.asname or imported.name, False


def python_names(path, text):
    """Names that a module or a class of Python defines twice, and private names of a module that nothing uses."""
    if path.suffix != ".py":
        return
    module = ast.parse(text)
    bodies = [module, *(node for node in ast.walk(module) if isinstance(node, ast.ClassDef))]
    for body in bodies:
        seen = set()
        for statement in body.body:
            for name, again in bound_names(statement):
                if name in seen and not again and name != "_":
                    yield path, statement.lineno, f"`{name}` is defined twice: the first definition is never used"
                seen.add(name)
    for statement in module.body:
        for name, _ in bound_names(statement):
            if re.match(r"_[A-Za-z]", name) and len(re.findall(rf"\b{name}\b", text)) == 1:
                yield path, statement.lineno, f"`{name}` is never used: remove it"


RULES = (banned_words, banned_grammar, missing_braces, torn_comments, long_test_names, header_without_page,
         large_source, large_function, long_line, python_names)

# Sources without a unit test of their own, by folder → the tests that cover them. `*` is every source below the folder.
UNIT_TESTED_ELSEWHERE = {
    ("client/core", "session"): "unit/core/connection_test",
    ("client/core", "request_queue subscriptions"): "unit/core/protocol_state_test: parts of the protocol state",
    ("client/core/example", "*"): "an example, which is only built",
    ("client/ctl", "*"): "system/evoctl_test: commands of evoctl, from the terminal to the server",
    ("client/viewer", "*"): "tests/system/viewer: windows, which need a display",
    ("proto/codec", "result"): "unit/codec/framing_test",
    ("server", "main"): "system/console_test",
    ("server/base", "column"): "unit/physics and unit/simulation: the memory of all columns",
    ("server/evolution", "free_genes"): "unit/evolution/free_gene_operators_test",
    ("server/commands", "backup"): "system/backup_test; its logic is run_file/backup",
    ("server/commands", "certificate"): "system/access_test; its logic is access/certificate",
    ("server/commands", "check_config"): "system/config_test; its logic is command_line/options_file",
    ("server/commands", "fork verify"): "system/run_file_test; their logic is replay/run_file_fork and replay/verify",
    ("server/commands", "lesson"): "system/lesson_test; its logic is experiments/lesson_check and lesson_texts",
    ("server/commands", "json_lines"): "unit/commands/run_test, sweep_test and compare_test: options of these commands",
    ("server/commands", "shared_worlds"): "system/mpi_test",
    ("server/commands", "data"): "system/disk_space_test; its logic is run_file/",
    ("server/commands", "prune"): "system/disk_space_test; its logic is run_file/ended_runs",
    ("server/commands", "limits parameters serve"): "system/console_test; their logic is parameters/ and serve_options",
    ("server/simulation", "local_islands run_parameters"): "unit/simulation/world_test and scheduled_world_test",
    ("server/simulation", "births body_grid hunt interval local_colonies"): "unit/simulation/colony_test",
    ("server/simulation/shared", "part"): "tests/determinism/shared_world_test and shared_laboratory_test",
    ("server/evolution", "breeding"): "unit/evolution/next_generation_test",
    ("server/experiments", "sweep_design"): "unit/experiments/sweep_file_test",
    ("server/network", "description http http_connection messages server_metrics transport"):
        "system.protocol, system.breeding, system.metrics, system.export and system.access: they need a running server",
    ("server/network", "session_sending"): "unit/network/session_test",
    ("server/network", "commands subscription_requests"): "unit/network/dispatcher_test",
    ("server/network", "heartbeat housekeeping listener"): "unit/network/server_test, system.metrics and system.access",
    ("server/physics", "motion_kernels"): "unit/physics/step_test and tests/determinism",
    ("server/recording", "disk_state log_jobs record_queue run_log storage_worker"):
        "unit/recording/storage_thread_test and recorder_test",
    ("server/replay", "table"): "unit/replay/run_tables_test",
    ("server/replay", "birth_table origins"): "unit/replay/colony_test",
    ("server/run_file", "more_genes"): "unit/replay/wide_run_test",
    ("server/run_file", "backup"): "system/backup_test: it needs a running server",
    ("server/run_file", "build checkpoints generations identity journal parameter_sets records row run_contents "
                        "run_database "
                        "schema table"): "unit/run_file/run_file_test, damage_test and checkpoint_test: parts of one "
                                         "file",
    ("server/run_file", "run_file_lock"): "unit/experiments/run_recording_test and system/run_test: it excludes other "
                                          "programs",
    ("server/runtime", "demand"): "unit/network/streams_test",
    ("server/runtime", "mpi_exchange"): "system/mpi_test: it needs mpirun",
    ("server/runtime", "command_handler pace replies run_finder snapshot"):
        "unit/runtime/simulation_loop_test, loop_queries_test, loop_snapshots_test, world_builds_test and "
        "replay_loop_test: parts of the loop",
    ("server/runtime", "seeks shown_replays"): "unit/runtime/replay_loop_test and system/past_test",
    ("server/jobs", "this_thread"): "unit/jobs/job_queue_test",
    ("server/simulation", "commands items_kernels organism_kernels statistics"):
        "unit/simulation/island_test and model_check, with every instruction set",
    ("server/streaming", "encoded_island"): "unit/streaming/snapshot_streams_test",
}


def untested_sources(names, text_of):
    """Sources that no unit test is about. A unit test is about a source if it mirrors its path, or includes its header.

    names    paths of the tree's files.
    text_of  returns the text of a file.
    """
    tests = {name for name in names if re.match(r"tests/unit/.*\.(cpp|h)$", name)}
    included = {header for test in tests for header in re.findall(r'^#include "([^"]+)"', text_of(test), re.M)}
    excepted = {(folder, stem) for folder, stems in UNIT_TESTED_ELSEWHERE for stem in stems.split()}
    used = set()
    for name in sorted(names):
        if not re.match(r"(server|client|proto)/.*\.cpp$", name):
            continue
        folder, stem = name[:-4].rsplit("/", 1)
        test = f"tests/unit/{name[:-4].split('/', 1)[1]}_test.cpp"
        if test in tests or f"{folder}/{stem}.h" in included:
            continue
        found = {one for one in excepted if one == (folder, stem) or one[1] == "*"
                 and f"{folder}/".startswith(one[0] + "/")}
        used |= found
        if not found:
            yield (pathlib.Path(name), 1,
                   f"no unit test: write {test}, or list in UNIT_TESTED_ELSEWHERE the tests that cover the source")
    for folder, stem in sorted(excepted - used):
        yield (pathlib.Path("tests/tidy/tidy.py"), 1,
               f"UNIT_TESTED_ELSEWHERE: {folder}/{stem}.cpp has a unit test or does not exist: remove the exception")


def unbuilt_tests(names, text_of):
    """Tests in C++ that no CMakeLists.txt builds. Arguments as in untested_sources()."""
    built = "\n".join(text_of(name) for name in names if pathlib.Path(name).name == "CMakeLists.txt")
    for name in sorted(names):
        if re.match(r"tests/.*_test\.cpp$", name) and not re.search(rf"\b{re.escape(pathlib.Path(name).name)}\b",
                                                                    built):
            yield pathlib.Path(name), 1, "no CMakeLists.txt builds this test: add it to the sources of a test program"


SENTENCE_WORDS_MIN = 4
# Folders to which the rule does not apply. core: the protocol is implemented once per language, and the tests compare
# the verdicts of all decoders; history_csv is such a reader, too. viewer: the labels, keys and notes of the widgets
# that both clients have, and the shader that both compile.
VOICES_APART = ("client/web/src/core/", "client/core/history_csv", "client/viewer/island/", "client/viewer/panels/",
                "client/viewer/text/numbers", "client/viewer/view/", "client/viewer/world/")
# Labels of states, axes, fields and empty plots: names of things rather than sentences.
LABELS = {"waits for the disk", "gene units per generation", "generation of the parents", "no generation has ended yet"}
SENTENCE_TEXT = re.compile(
    r"""//[^\n]*|/\*.*?\*/|\#[^\n]*
                       |(?P<quote>\"{3}|["'`])(?P<text>(?:\\.|(?!(?P=quote)).)*?)(?P=quote)""", re.S | re.X)


def sentences_of(path, text):
    """The sentences in the text literals of a source, as words in lower case → line. Literals in a row are one."""
    if path.suffix == ".py":
        docstring = r'(?m)^\s*"{3}.*?"{3}'
        text = re.sub(docstring, lambda found: "\n" * found.group().count("\n"), text, flags=re.S)
        text = re.sub(r"(?m)^\s*#.*$", "", text)
    sentences, literal, start, end = {}, "", 0, -1
    for found in [*SENTENCE_TEXT.finditer(text), None]:
        if found is not None and found["text"] is None:
            continue
        if found is None or text[end:found.start()].strip(" \t\n\\+fr"):
            for part in re.split(r"\$?\{[^{}]*\}|%[-.\d]*[a-z]+|[:;,.!?()–…]+\s", literal + " "):
                words = re.findall(r"[a-z_]+", part.lower())
                if len(words) >= SENTENCE_WORDS_MIN:
                    sentences.setdefault(" ".join(words), line_of(text, start))
            literal = ""
        if found is not None:
            start = found.start() if not literal else start
            literal += found["text"].replace("\\n", " ")
            end = found.end()
    return sentences


def second_voices(names, text_of):
    """Sentences that the browser page has in common with a program in C++ or Python: one of both has to send it, or
    both read it from a file. Arguments as in untested_sources()."""
    others = {}
    for name in names:
        if re.match(r"(server|client|proto)/.*\.(cpp|h|py)$", name) and not name.startswith(VOICES_APART):
            for sentence, line in sentences_of(pathlib.Path(name), text_of(name)).items():
                others.setdefault(sentence, f"{name}:{line}")
    for name in names:
        if re.match(r"client/web/src/.*\.ts$", name) and not name.startswith(VOICES_APART):
            for sentence, line in sentences_of(pathlib.Path(name), text_of(name)).items():
                if sentence in others.keys() - LABELS:
                    yield (pathlib.Path(name), line,
                           f"'{sentence}' stands in {others[sentence]}, too: let one of both say it")


def findings(root):
    """(path, line, what is wrong) of every rule and every tracked file below `root`."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=root, capture_output=True, check=True).stdout.decode()
    names = [name for name in filter(None, listed.split("\0")) if (root / name).is_file()]
    for name in names:
        path = pathlib.Path(name)
        if path.suffix not in TEXT:
            continue
        try:
            text = (root / path).read_text()
        except UnicodeDecodeError:
            continue
        for rule in RULES:
            if rule in (banned_words, banned_grammar) and WITHOUT_WORDS.search(name):
                continue
            yield from rule(path, text)
    yield from untested_sources(names, lambda name: (root / name).read_text())
    yield from unbuilt_tests(names, lambda name: (root / name).read_text())
    yield from second_voices(names, lambda name: (root / name).read_text())


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2]
    found = [f"{path}:{line}: {what}" for path, line, what in findings(root)]
    print("\n".join(found) or "tidy")
    sys.exit(bool(found))
