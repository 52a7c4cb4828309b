// Twins: the oracle of a history. They are the same worlds with the same commands at the same ticks, but they are never
// stopped, stored, restored or shared. A fork is a copy of its origin, taken at the moment with which it begins.
//
// Determinism  a twin remembers the state hash after each of its ticks, and each of its generations as it began.
#pragma once

#include "server/base/inline_executor.h"
#include "server/simulation/laboratory.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace evod::histories {

/// What a twin remembers of its run.
struct Memory {
    std::map<std::uint64_t, base::StateHash> hashes;     // by tick: the hash after the tick and the commands there
    std::map<std::uint64_t, simulation::World> openings; // by generation: the world at its first moment
};

class Twins {
  public:
    base::Result<simulation::Applied> apply(const simulation::Command& command);
    /// Advances a world up to a tick. Returns false if it ends before, or awaits fitness.
    bool advance(const std::string& name, std::uint64_t tick);

    const simulation::Laboratory& laboratory() const { return laboratory_; }
    const simulation::Entry* find(const std::string& name) const;
    const Memory& memory(const std::string& name) const { return memories_.at(name); }

  private:
    base::Result<simulation::Applied> fork(const simulation::ForkWorld& command);
    void begin_memory(const std::string& name);
    void remember(const simulation::Entry& entry);

    base::InlineExecutor executor_;
    simulation::Laboratory laboratory_;
    std::map<std::string, Memory> memories_; // by name of the world
};

} // namespace evod::histories
