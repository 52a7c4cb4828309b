// Completion: what a user may type next, found in the tables of options and subcommands. bash, zsh and fish run small
// scripts that call `PROGRAM complete -- WORDS…` and offer the lines that it prints.
//
// Threads  one.
#pragma once

#include "proto/command_line/command.h"

#include <functional>
#include <string>
#include <vector>

namespace evod::command_line {

struct Candidate {
    std::string text, help; // help: may be empty
};

/// The word that the user is typing, and its context.
struct IncompleteWord {
    std::vector<std::string> before; // the words between the program and this word
    std::string command;             // the subcommand among them, "set" or "token add"; empty: none
    std::string option;              // "--world" if the word is the value of this option; empty: a positional value
    std::string word;                // the beginning that the user has typed
};

/// Returns values that only the program knows, such as the names of worlds. May return candidates that do not begin
/// with the word.
using ValueCandidates = std::function<std::vector<Candidate>(const IncompleteWord&)>;

/// Returns the candidates for the last word. If there are none, the shell offers files.
///
/// words  the words after the name of the program; the last one is incomplete, perhaps empty.
std::vector<Candidate> candidates(const Command& program, const std::vector<std::string>& words,
                                  const ValueCandidates& values = {});

/// Shells with completion.
inline const std::vector<std::string> shells{"bash", "zsh", "fish"};
/// Returns the script for a shell.
std::string completion_script(const std::string& shell, const std::string& program);

/// Adds the commands `help [COMMAND]`, `complete SHELL` and `man`, which print text that is generated from the tables
/// of the program. The program must not be moved afterwards.
void add_help_commands(Command& program);

/// If the command line is `PROGRAM complete -- WORDS…`, prints the candidates and returns true.
bool complete(const Command& program, int argument_count, const char* const* arguments,
              const ValueCandidates& values = {});

} // namespace evod::command_line
