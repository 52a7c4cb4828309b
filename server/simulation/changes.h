// Changes: which parameters of a run changed, in which generation, and by whom. Clients mark them in plots. They are
// not part of the state: no result depends on them.
//
// Owner        World.
// Threads      none of its own.
#pragma once

#include "server/base/actor.h"
#include "server/parameters/model_parameters.h"

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace evod::simulation {

struct ChangedValue {
    std::string name; // name of the parameter
    parameters::ParameterValue before, after;
    friend bool operator==(const ChangedValue&, const ChangedValue&) = default;
};

struct Change {
    std::uint64_t generation = 0; // the generation of the change; between two generations, the next one
    base::Actor by;               // the client that made or planned the change, or the schedule
    std::vector<ChangedValue> values;
    friend bool operator==(const Change&, const Change&) = default;
};

class Changes {
  public:
    /// The maximum number of changed values that are kept. The oldest changes are dropped first.
    static constexpr std::size_t values_kept = 10'000;

    /// Adds the requested parameters that differ. Ignores parameters that change only with a reset, because a reset
    /// begins another run.
    void add(std::uint64_t generation, base::Actor by, const parameters::RequestedParameters& before,
             const parameters::RequestedParameters& after);
    void clear() { *this = {}; }

    /// The changes, oldest first.
    const std::deque<Change>& all() const { return all_; }

  private:
    std::deque<Change> all_;
    std::size_t value_count_ = 0; // in all changes together
};

} // namespace evod::simulation
