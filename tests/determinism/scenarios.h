// Scenarios: worlds that between them use everything the model has, with the commands given while they run.
//
// Determinism  a scenario is data: equal runs of it give equal hashes after every tick.
#pragma once

#include "server/simulation/laboratory.h"

#include <cstdint>
#include <iosfwd>
#include <string_view>
#include <vector>

namespace evod::scenarios {

/// Assignments given before the tick with this number is taken; tick 1 is the first of a run.
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

/// The parameters of a text as in an experiment file; the text must be right.
parameters::Parameters parameters_of(std::string_view experiment);

/// A scenario under way, as the only world of a laboratory.
class Play {
  public:
    explicit Play(const Scenario& scenario) : Play{scenario, scenario.seed} {}
    Play(const Scenario& scenario, base::Seed seed);

    /// One tick, with the commands that come before it.
    void advance(base::Executor& executor);

    const simulation::World& world() const { return laboratory_.entries().front()->world; }
    simulation::Laboratory& laboratory() { return laboratory_; }

  private:
    const Scenario& scenario_;
    simulation::Laboratory laboratory_;
};

} // namespace evod::scenarios
