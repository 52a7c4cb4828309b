// Options file: a file with options of a program, one on a line: `name = value`, or the name alone for a flag. The
// names are those of the long options without dashes. `#` begins a comment, at the start of a line or after a blank.
//
// Threads  one.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace evod::command_line {

/// The contents of a file as words of a command line, or everything that is wrong with it.
struct FileOptions {
    std::vector<std::string> words;  // "--port=7744", "--web"
    std::vector<std::string> errors; // "FILE:LINE: web: got yes, allowed no value", in the order of the lines
};

/// Reads a file with options of this program. An option that the command line contains, or excludes, is left out.
///
/// program  after it has parsed the command line. It must parse again afterwards, because the values of the file are
///          checked in its options.
/// itself   the option that names the file.
FileOptions read_options_file(const std::string& path, CLI::App& program, const CLI::Option& itself);

} // namespace evod::command_line
