#include "client/ctl/student_list.h"

#include "client/ctl/text.h"
#include "proto/text/csv.h"

#include <algorithm>
#include <map>
#include <string_view>

namespace evod::ctl {
namespace {

constexpr std::size_t characters_max = 24;

std::string_view trimmed(std::string_view cell) {
    constexpr std::string_view blanks = " \t";
    const std::size_t begin = std::min(cell.find_first_not_of(blanks), cell.size());
    cell.remove_prefix(begin);
    return cell.substr(0, cell.find_last_not_of(blanks) + 1);
}

bool is_heading(std::string_view name) {
    return name == "name" || name == "Name" || name == "NAME";
}

/// What is wrong with a name; empty if nothing is.
std::string fault_of(std::string_view name) {
    if (name.empty()) {
        return "the name is missing";
    }
    if (std::ranges::any_of(name, [](unsigned char c) { return c < 0x20 || c == 0x7f; })) {
        return "the name contains a control character";
    }
    if (const std::size_t characters = width_of(name); characters > characters_max) {
        return "the name has " + std::to_string(characters) + " characters, allowed 1 to " +
               std::to_string(characters_max);
    }
    return "";
}

} // namespace

Checked<std::vector<ListedStudent>> read_students(std::istream& in) {
    std::vector<ListedStudent> students;
    std::map<std::string, std::uint64_t, std::less<>> lines; // by name
    Mistakes mistakes;
    text::CsvReader reader{in, text::Separator::FromHeading};
    while (reader.next()) {
        const std::string_view name = trimmed(reader.cells()[0]);
        const bool is_empty_line = reader.cells().size() == 1 && name.empty();
        if (is_empty_line || (reader.line() == 1 && is_heading(name))) {
            continue;
        }
        const auto [known, is_new] = lines.try_emplace(std::string{name}, reader.line());
        std::string fault = fault_of(name);
        if (fault.empty() && !is_new) {
            fault = std::string{name} + " stands in line " + std::to_string(known->second) + " already";
        }
        if (!fault.empty()) {
            mistakes.lines.push_back("line " + std::to_string(reader.line()) + ": " + fault);
        }
        students.push_back({std::string{name}, reader.line()});
    }
    if (reader.has_open_quote()) {
        mistakes.lines.push_back("line " + std::to_string(reader.line()) + ": a quotation mark is not closed");
    }
    if (students.empty() && mistakes.lines.empty()) {
        mistakes.lines.emplace_back("the list contains no names");
    }
    if (!mistakes.lines.empty()) {
        return mistakes;
    }
    return students;
}

} // namespace evod::ctl
