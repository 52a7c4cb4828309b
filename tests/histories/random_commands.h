// Random commands: what clients request of the worlds of a history.
#pragma once

#include "evod/v1/commands.pb.h"
#include "tests/histories/draws.h"
#include "tests/histories/random_parameters.h"
#include "tests/histories/twins.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace evod::histories {

/// Draws a generation from whose first moment a world can be forked; nullopt: from now.
std::optional<std::uint64_t> forkable_generation(const Memory& memory, Draws& draws);

class RandomCommands {
  public:
    explicit RandomCommands(Draws& draws) : draws_{draws}, turns_{draws.below(1000)} {}

    /// Draws requests that are to be applied between the same two ticks. After them, every world comes to rest.
    std::vector<v1::Request> next(const Twins& twins);
    /// Draws requests that make a world advance to a later moment.
    std::vector<v1::Request> advance(const simulation::Entry& entry);
    /// Requests that advance a world up to this tick.
    v1::Request until(const simulation::Entry& entry, std::uint64_t tick);

    std::string unused_name() { return "w" + std::to_string(++names_); }

  private:
    /// A new request, with its own id.
    v1::Request request();
    v1::Request create();
    v1::Request set_parameters(const simulation::Entry& entry);
    v1::Request cancel(const simulation::Entry& entry);
    v1::Request place(const simulation::Entry& entry);
    v1::Request remove(const simulation::Entry& entry);
    v1::Request set_fitness(const simulation::Entry& entry);
    v1::Request reset(const simulation::Entry& entry);
    v1::Request fork(const simulation::Entry& entry, const Memory& memory);
    std::vector<v1::Request> control(const simulation::Entry& entry);

    Draws& draws_;
    ParameterTurns turns_;
    std::uint64_t requests_ = 0, names_ = 0;
};

} // namespace evod::histories
