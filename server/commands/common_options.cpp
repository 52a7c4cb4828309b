#include "server/commands/common_options.h"

#include "proto/command_line/terminal.h"
#include "proto/command_line/words.h"
#include "server/base/exact_number.h"
#include "server/base/instructions.h"
#include "server/parameters/warnings.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <thread>

namespace evod::commands {

int fail(const std::string& error) {
    command_line::print_error("evod", error);
    return exit_error;
}

int fail(const base::Refusal& error) {
    const auto names_option = [](const base::Violation& violation) { return violation.field.starts_with("--"); };
    if (error.violations.empty() || !std::ranges::all_of(error.violations, names_option)) {
        return fail(base::to_text(error));
    }
    for (const base::Violation& violation : error.violations) { // each says what the message says
        fail(base::to_text(violation));
    }
    return exit_error;
}

void warn(const std::string& warning) {
    std::cerr << "evod: warning: " << warning << "\n";
}

std::optional<std::string> warning_about(std::optional<base::Seed> seed) {
    if (!seed || base::is_portable(*seed)) {
        return std::nullopt;
    }
    return "seed " + std::to_string(seed->value) +
           ": R, JavaScript and spreadsheet programs round whole numbers from 2^53 on, so a table that they have "
           "written no longer repeats this run; choose a seed below 9007199254740992";
}

void warn_about(const parameters::Parameters& parameters, std::optional<base::Seed> seed) {
    for (const std::string& warning : parameters::warnings_of(parameters)) {
        warn(warning);
    }
    if (const auto warning = warning_about(seed)) {
        warn(*warning);
    }
}

std::size_t default_thread_count() {
    return std::max(1u, std::thread::hardware_concurrency());
}

bool use_instructions_of_environment() {
    const char* const name = std::getenv("EVOD_INSTRUCTIONS");
    if (name == nullptr || *name == '\0' || base::use_instructions(name)) {
        return true;
    }
    fail("EVOD_INSTRUCTIONS: got " + std::string{name} + ", allowed on this processor " +
         command_line::joined(base::available_instructions()));
    return false;
}

std::optional<std::string> data_folder_or_default(const std::string& given) {
    if (!given.empty()) {
        return given;
    }
    // The XDG Base Directory Specification requires programs to ignore a relative path.
    if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state == '/') {
        return std::string{state} + "/evod";
    }
    if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') {
        return std::string{home} + "/.local/state/evod";
    }
    return std::nullopt;
}

bool find_data_folder(std::string& folder) {
    const auto found = data_folder_or_default(folder);
    if (!found) {
        fail(no_data_folder);
        return false;
    }
    folder = *found;
    return true;
}

} // namespace evod::commands
