// Choice help: one sentence for each choice of a CHOICE parameter. Clients show it next to the choice.
//
// Owner        none: a constant table.
// Threads      any.
#pragma once

#include <string_view>

namespace evod::parameters {

/// Returns the sentence about this choice, such as "roulette" of the parameter "selection"; empty if there is none.
std::string_view choice_help(std::string_view parameter, std::string_view choice);

} // namespace evod::parameters
