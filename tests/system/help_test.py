"""Help, man pages and completions: each contains every option and command of its program. EVOD and EVOCTL name the
programs."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

import waiting

PROGRAMS = [os.environ["EVOD"], os.environ["EVOCTL"]]
# Programs are called by name, as a shell calls them. No server answers here.
ENVIRONMENT = {**os.environ, "PATH": os.pathsep.join([*map(os.path.dirname, PROGRAMS), os.environ["PATH"]]),
               "EVOD_SERVER": "127.0.0.1:1", "TERM": "dumb"}


def printed(*words, **options):
    done = waiting.run([*words], capture_output=True, text=True, env=ENVIRONMENT, **options)
    assert done.returncode == 0, f"{words}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def tables(program, words=()):
    """What --help lists: yields the words of each command, with its options, commands and allowed words."""
    text = printed(program, *words, "--help")
    options = set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", text, re.M)) | set(re.findall(r"^  -\w,(--[\w-]+)", text, re.M))
    listed = text.split("\n\n")
    commands = [name for part in listed if not re.match(r"\w.*:\n  -|Options|Positionals|Usage|Examples", part)
                for name in re.findall(r"^  ([a-z-]+) {3,}\S", part, re.M)] if "SUBCOMMAND" in text else []
    yield tuple(words), options, commands
    for name in commands:
        yield from tables(program, (*words, name))


def in_bash(program, lines):
    script = f'source <({program} complete bash)\n' + "".join(
        f'COMP_LINE="{line}"; COMP_POINT=${{#COMP_LINE}}; _{program}; echo "${{COMPREPLY[@]}}"\n' for line in lines)
    return printed("bash", "--norc", "-c", script).splitlines()


def in_zsh(program, lines):
    # zsh calls the function with the words; here they are set by hand, and what it offers is printed.
    script = 'compdef() { : }\n_files() { : }\n_describe() { print -rn -- "${(@)${(@P)2}%%:*} " }\n' \
             f'source <({program} complete zsh)\n'
    for line in lines:
        words = line.split(" ")
        script += f'words=({" ".join(repr(word) for word in words)}); CURRENT={len(words)}; PREFIX={words[-1]!r}; ' \
                  f'_{program}; print\n'
    return printed("zsh", "-f", "-c", script).splitlines()


def in_fish(program, lines):
    with tempfile.TemporaryDirectory() as home:
        script = f"{program} complete fish | source\n" + "".join(
            f'set found (complete -C "{line}" | string split -f1 \\t); echo "$found"\n' for line in lines)
        return waiting.run(["fish", "--no-config", "-c", script], capture_output=True, text=True,
                           env={**ENVIRONMENT, "HOME": home}).stdout.splitlines()


class Generated(unittest.TestCase):
    def setUp(self):
        self.programs = {os.path.basename(program): list(tables(program)) for program in PROGRAMS}

    def test_help_lists_every_command_and_option(self):
        evod, evoctl = (dict((words, (options, commands)) for words, options, commands in listed)
                        for listed in self.programs.values())
        self.assertLessEqual({"--help", "--version", "--port", "--tls-cert", "--data", "--seed", "--log-level"},
                             evod[()][0])
        self.assertLessEqual({"run", "sweep", "replay", "token", "help", "complete", "man"}, set(evod[()][1]))
        self.assertLessEqual({"--role", "--data"}, evod["token", "add"][0])
        self.assertLessEqual({"create", "run", "set", "top", "help", "complete", "man"}, set(evoctl[()][1]))
        self.assertLessEqual({"--dry-run", "--at-tick"}, evoctl["set",][0])

    def test_options_have_headings(self):
        for program, headings in (("evod", ["Listening", "Access and TLS", "Storage", "First world", "Log",
                                            "Experiments"]),
                                  ("evoctl", ["Connection", "Worlds", "Run", "Parameters", "Look", "Follow", "Help"])):
            text = printed(program, "--help")
            for heading in headings:
                self.assertRegex(text, rf"\n\n{heading}:\n  ")
            self.assertNotIn("\n\n\n", text)
            self.assertLessEqual(max(map(len, text.splitlines())), 100)

    def test_help_of_a_command_is_that_of_its_option(self):
        for program, listed in self.programs.items():
            for words, _, _ in listed:
                self.assertEqual(printed(program, "help", *words), printed(program, *words, "--help"))
            self.assertEqual(printed(program, "-V"), printed(program, "--version"))

    def check_shell(self, complete):
        for program, listed in self.programs.items():
            lines = [" ".join([program, *words, end]) for words, _, _ in listed for end in ("--", "")]
            offered = complete(program, lines)
            self.assertEqual(len(offered), len(lines), offered)
            for i, (words, options, commands) in enumerate(listed):
                self.assertLessEqual(options, set(offered[2 * i].split()), words)
                self.assertLessEqual(set(commands), set(offered[2 * i + 1].split()), words)
        chosen = complete("evod", ["evod export x.evod --what l", "evod complete ", "evod sw", "evod run --se"])
        self.assertEqual([line.split() for line in chosen], [["lineage"], ["bash", "zsh", "fish"], ["sweep"],
                                                             ["--seed", "--set"]]
                         if complete is not in_fish else [["lineage"], ["bash", "fish", "zsh"], ["sweep"],
                                                          ["--seed", "--set"]])

    def test_bash_offers_everything(self):
        self.check_shell(in_bash)

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed: scripts/setup tests")
    def test_zsh_offers_everything(self):
        self.check_shell(in_zsh)

    @unittest.skipUnless(shutil.which("fish"), "fish is not installed: scripts/setup tests")
    def test_fish_offers_everything(self):
        self.check_shell(in_fish)

    def test_man_pages_contain_everything(self):
        for program, listed in self.programs.items():
            page = printed(program, "man")
            sections = re.split(r'^\.S[SH] "?(.*?)"?$', page.replace("\\-", "-"), flags=re.M)
            of_command = dict(zip(sections[1::2], sections[2::2]))
            for words, options, _ in listed:
                text = of_command[" ".join(words)] if words else page.replace("\\-", "-")
                for option in options - ({"--help"} if words else set()):
                    self.assertIn(f"\\fB{option}\\fR", text, words)

    @unittest.skipUnless(shutil.which("mandoc"), "mandoc is not installed: scripts/setup tests")
    def test_man_pages_have_no_fault(self):
        for program in self.programs:
            done = subprocess.run(["mandoc", "-Tlint"], input=printed(program, "man"), capture_output=True, text=True)
            # A date would change with each build, so the page has none.
            self.assertEqual([line for line in done.stdout.splitlines() if "missing date" not in line], [])

    def test_a_folder_of_the_build_contains_them(self):
        for program in PROGRAMS:
            name = os.path.basename(program)
            folder = pathlib.Path(program).parents[1] / "documents"
            for words, file in ((["man"], f"{name}.1"), (["complete", "bash"], name), (["complete", "zsh"], f"_{name}"),
                                (["complete", "fish"], f"{name}.fish")):
                self.assertEqual((folder / file).read_text(), printed(program, *words))


if __name__ == "__main__":
    unittest.main()
