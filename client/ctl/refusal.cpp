#include "client/ctl/refusal.h"

#include "client/core/client_types.h"
#include "proto/command_line/command.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

namespace evod::ctl {
namespace {

/// Fields that no option of the same name sets.
constexpr std::array<std::pair<std::string_view, std::string_view>, 14> options_of_fields{{
    {"at.generation", "--at-generation"},
    {"at.tick", "--at-tick"},
    {"to.generation", "--generation"},
    {"to.tick", "--tick"},
    {"expected_revision", "--if-revision"},
    {"experiment_json", "--experiment"},
    {"population_gene_names", "--population"},
    {"first_generation", "--from"},
    {"last_generation", "--to"},
    {"table", "--what"},
    {"generations", "N"},
    {"organism", "ID"},
    {"tick", "TICK"},
    {"speed.real_time_factor", "SPEED"},
}};

/// The name under which the user gave the value of a field; empty if no option or value of the command has this name.
std::string option_of(std::string_view field, const command_line::Command* command) {
    std::string word{field};
    std::ranges::replace(word, '_', '-');
    if (command != nullptr) {
        for (const auto& option : command->options()) {
            std::string positional = option.positional;
            std::ranges::transform(positional, positional.begin(), [](unsigned char c) { return std::tolower(c); });
            if (positional == field) {
                return option.positional;
            }
            if (std::ranges::find(option.names, "--" + word) != option.names.end()) {
                return "--" + word;
            }
        }
    }
    if (field == "world") {
        return "--world";
    }
    const auto* const found =
        std::ranges::find(options_of_fields, field, &std::pair<std::string_view, std::string_view>::first);
    return found == options_of_fields.end() ? "" : std::string{found->second};
}

/// "--at-generation" for "fork_world.at_generation"; "mutation_chance" for "set_parameters.mutation_chance";
/// "--experiment: mutation_chance (line 2)" for "create_world.experiment_json.mutation_chance (line 2)".
std::string name_of(std::string_view path, const command_line::Command* command) {
    const std::size_t request_end = path.find('.');
    const std::string_view field = request_end == std::string_view::npos ? path : path.substr(request_end + 1);
    if (std::string option = option_of(field, command); !option.empty()) {
        return option;
    }
    // A part of a file or of a value.
    const std::size_t end = std::min(field.find_first_of(".["), field.size());
    const std::string option = end == field.size() ? "" : option_of(field.substr(0, end), command);
    return option.empty() ? std::string{field}
                          : option + ": " + std::string{field.substr(field[end] == '.' ? end + 1 : end)};
}

} // namespace

std::string refusal_text(const v1::Status& status, const command_line::Command* command) {
    return core::to_text(status, [command](std::string_view path) { return name_of(path, command); });
}

} // namespace evod::ctl
