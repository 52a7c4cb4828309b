#include "proto/command_line/options_file.h"

#include "proto/command_line/usage_error.h"
#include "proto/files/input_file.h"
#include "proto/text/printable.h"
#include "proto/text/suggestion.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <utility>

namespace evod::command_line {
namespace {

constexpr std::size_t file_bytes_max = 1 << 20, line_bytes_max = 4096, errors_max = 100;
constexpr std::string_view blanks = " \t";

std::string_view trimmed(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(blanks);
    return begin == std::string_view::npos ? std::string_view{}
                                           : text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

std::string_view without_comment(std::string_view line) {
    for (std::size_t at = line.find('#'); at != std::string_view::npos; at = line.find('#', at + 1)) {
        if (at == 0 || blanks.find(line[at - 1]) != std::string_view::npos) {
            return line.substr(0, at);
        }
    }
    return line;
}

bool is_plain_text(std::string_view line) {
    while (!line.empty()) {
        const std::size_t bytes = text::character_bytes(line);
        if (bytes == 0 || (line.front() != '\t' && text::unsafe_character_bytes(line) > 0)) {
            return false;
        }
        line.remove_prefix(bytes);
    }
    return true;
}

bool is_flag(const CLI::Option& option) {
    return option.get_items_expected_max() == 0;
}

class Reader {
  public:
    Reader(CLI::App& program, const CLI::Option& itself) : program_{program}, itself_{itself} {
        for (const CLI::Option* option : std::as_const(program).get_options()) {
            if (option->count() > 0 && option != &itself) {
                for (const CLI::Option* other : option->get_excludes()) {
                    left_out_.insert(other);
                }
                left_out_.insert(option);
            }
        }
    }

    FileOptions read(const std::string& path, std::string_view text) {
        if (text.starts_with("\xef\xbb\xbf")) { // a byte order mark
            text.remove_prefix(3);
        }
        for (std::size_t number = 1; !text.empty(); ++number) {
            const std::size_t end = std::min(text.find('\n'), text.size());
            std::string_view line = text.substr(0, end);
            text.remove_prefix(std::min(end + 1, text.size()));
            if (line.ends_with('\r')) {
                line.remove_suffix(1);
            }
            if (const std::string error = take(number, line); !error.empty()) {
                errors_.emplace(number, error);
            }
        }
        check_values();
        FileOptions result;
        for (const auto& [number, error] : errors_) {
            if (result.errors.size() == errors_max) {
                result.errors.push_back(path + ": " + std::to_string(errors_.size() - errors_max) + " more errors");
                break;
            }
            result.errors.push_back(path + ":" + std::to_string(number) + ": " + error);
        }
        for (const Entry& entry : entries_) {
            result.words.push_back(entry.option->get_name() + (is_flag(*entry.option) ? "" : "=" + entry.value));
        }
        return result;
    }

  private:
    struct Entry {
        std::size_t line;
        CLI::Option* option;
        std::string value; // empty for a flag
    };

    /// Takes one line. Returns what is wrong with it; an empty text if it is valid.
    std::string take(std::size_t number, std::string_view line) {
        if (line.size() > line_bytes_max) {
            return "got a line of " + std::to_string(line.size()) + " bytes, allowed " + std::to_string(line_bytes_max);
        }
        if (!is_plain_text(line)) {
            return "the line contains a control character, or bytes that are not UTF-8";
        }
        line = trimmed(without_comment(line));
        if (line.empty()) {
            return {};
        }
        const std::size_t name_end = std::min(line.find_first_of("= \t"), line.size());
        const std::string name{line.substr(0, name_end)};
        std::string_view rest = trimmed(line.substr(name_end));
        CLI::Option* const option = name.empty() ? nullptr : program_.get_option_no_throw("--" + name);
        if (option == nullptr) {
            return (name.empty() ? "=" : name) + ": unknown option" + text::did_you_mean(name, names());
        }
        if (option == &itself_ || option == program_.get_help_ptr() || option == program_.get_version_ptr()) {
            return name + ": not allowed in a file";
        }
        const bool has_value = rest.starts_with('=');
        if (!has_value && !rest.empty()) {
            return name + ": got " + std::string{rest} + " without =, allowed " + name +
                   (is_flag(*option) ? "" : " = " + std::string{rest});
        }
        rest = has_value ? trimmed(rest.substr(1)) : rest;
        if (is_flag(*option) && has_value) {
            return name + ": got " + (rest.empty() ? "=" : std::string{rest}) + ", allowed no value";
        }
        if (!is_flag(*option) && rest.empty()) {
            return without_dashes(missing(*option));
        }
        const auto [first, is_first] = first_lines_.emplace(option, number);
        if (!is_first && option->get_items_expected_max() <= 1) {
            return name + ": given twice, first in line " + std::to_string(first->second);
        }
        for (const CLI::Option* other : option->get_excludes()) {
            if (first_lines_.contains(other)) {
                return name + ": not allowed with " + other->get_name().substr(2) + " in line " +
                       std::to_string(first_lines_.at(other));
            }
        }
        if (!left_out_.contains(option)) {
            option->add_result(is_flag(*option) ? "true" : std::string{rest}); // a check may ask whether it is given
            entries_.push_back({number, option, std::string{rest}});
        }
        return {};
    }

    /// Lets the program check each value alone, so that every wrong one is found.
    void check_values() {
        for (const Entry& entry : entries_) {
            if (is_flag(*entry.option)) {
                continue;
            }
            entry.option->clear();
            entry.option->add_result(entry.value);
            try {
                entry.option->run_callback();
            } catch (const CLI::ParseError& error) {
                errors_.emplace(entry.line, without_dashes(error.what()));
            }
        }
    }

    static std::string without_dashes(const std::string& error) {
        return error.starts_with("--") ? error.substr(2) : error;
    }

    /// The names of all options that a file may contain.
    std::vector<std::string> names() const {
        std::vector<std::string> names;
        for (const CLI::Option* option : std::as_const(program_).get_options()) {
            if (option != &itself_ && option != program_.get_help_ptr() && option != program_.get_version_ptr()) {
                names.push_back(option->get_name().substr(2));
            }
        }
        return names;
    }

    CLI::App& program_;
    const CLI::Option& itself_;
    std::set<const CLI::Option*> left_out_;
    std::map<const CLI::Option*, std::size_t> first_lines_; // of each option
    std::vector<Entry> entries_;
    std::map<std::size_t, std::string> errors_; // by line
};

} // namespace

FileOptions read_options_file(const std::string& path, CLI::App& program, const CLI::Option& itself) {
    const auto text = files::read_input(path, "a configuration file", file_bytes_max);
    if (!text) {
        return {.words = {}, .errors = {path + ": " + text.error().why}};
    }
    return Reader{program, itself}.read(path, *text);
}

} // namespace evod::command_line
