// Scenarios: worlds that together use every feature of the model, with the commands given while they run.
//
// Determinism  a scenario is data: repeated runs give equal hashes after every tick.
#pragma once

#include "server/simulation/laboratory.h"

#include <cstdint>
#include <iosfwd>
#include <string_view>
#include <vector>

namespace evod::scenarios {

/// Assignments made before the tick with this number; tick 1 is the first of a run.
struct Change {
    std::uint64_t tick;
    std::string_view parameters; // as in an experiment file
};

struct Scenario {
    const char* name;
    std::string_view experiment;
    base::Seed seed;
    std::uint64_t ticks;
    std::vector<Change> changes;
};

void PrintTo(const Scenario& scenario, std::ostream* out); // for the names of tests

const std::vector<Scenario>& all();

/// Parses parameters as in an experiment file; the text must be valid.
parameters::Parameters parameters_of(std::string_view experiment);

/// A running scenario, as the only world of a laboratory.
class Play {
  public:
    explicit Play(const Scenario& scenario) : Play{scenario, scenario.seed} {}
    Play(const Scenario& scenario, base::Seed seed);

    /// Performs one tick, after the commands that precede it.
    void advance(base::Executor& executor);

    const simulation::World& world() const { return laboratory_.entries().front()->world; }
    simulation::Laboratory& laboratory() { return laboratory_; }

  private:
    const Scenario& scenario_;
    simulation::Laboratory laboratory_;
};

} // namespace evod::scenarios
