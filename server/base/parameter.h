// Parameter descriptions: name, range, unit, default and help text of each parameter of the core.
//
// A folder lists its parameters once, as REAL, COUNT, FLAG and CHOICE lines (evolution/ga_parameters.h and
// parameters/model_parameters.h). From that list, macros generate the struct with its defaults and the descriptions.
// Validation, JSON files, the protocol, evoctl's help and docs/PARAMETERS.md use the descriptions, so a new parameter
// needs only one new line.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <variant>

namespace evod::base {

/// The time at which a changed value takes effect.
enum class Effect {
    NextTick,       // from the tick at which the command is applied; a breeding parameter: from the next breeding
    NextGeneration, // from the first tick of the next generation
    Reset,          // when the world is reset or created
};

constexpr std::uint32_t count_max = std::numeric_limits<std::uint32_t>::max();

struct RealRange {
    double min, max; // both inclusive
};
struct CountRange {
    std::uint32_t min, max; // both inclusive
};

/// Specialised by EVOD_CHOICE_NAMES for every enumeration that a CHOICE parameter can hold.
template <class Enumeration>
struct ChoiceNames;

} // namespace evod::base

/// Defines the names that users write for the enumerators of Type, in order. Use it at global scope.
#define EVOD_CHOICE_NAMES(Type, ...)                                                                                   \
    template <>                                                                                                        \
    struct evod::base::ChoiceNames<Type> {                                                                             \
        static constexpr std::string_view names[] = {__VA_ARGS__};                                                     \
    };
