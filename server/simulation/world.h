// World: one experiment with its parameters, seed, islands and history. Pure: ticks happen when advance_tick is called.
//
// A moment is (generation, tick within it). A generation's last tick ends it: statistics are made and the world stands
// there, its dead and living still to be looked at, until the next advance_tick breeds the next generation and takes
// its first tick. So breeding uses the parameters that hold when it happens.
//
// What a schedule plans for a generation is asked for before that one is bred: so many are born, on islands like that.
// What does not wait for a generation holds from its first tick, so that breeding still goes by what held before. At
// the first moment of a generation a world therefore has what bred it, and what it is about to have is requested.
//
// Threads      called on the simulation thread; work goes to the executor it is handed.
// Determinism  the state after any tick is a pure function of (parameters, schedule, seed, changes at their ticks).
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"
#include "server/base/result.h"
#include "server/base/state_hash.h"
#include "server/evolution/termination.h"
#include "server/parameters/parameters.h"
#include "server/parameters/schedule.h"
#include "server/simulation/commands.h"
#include "server/simulation/events.h"
#include "server/simulation/island.h"
#include "server/simulation/statistics.h"
#include "server/simulation/world_state.h"

#include <algorithm>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

namespace evod::simulation {

/// What held when a generation began, before its first tick.
struct Opening {
    Moment moment; // generation_tick 0
    parameters::ParameterSet parameters;
    evolution::Progress progress; // of the generations before it
};

/// The statistics of an ended generation, one entry per island. They never change, and copies share them.
class GenerationRows {
  public:
    GenerationRows(std::vector<GenerationStatistics> rows)
        : rows_{std::make_shared<const std::vector<GenerationStatistics>>(std::move(rows))} {}
    operator const std::vector<GenerationStatistics>&() const { return *rows_; }

    std::size_t size() const { return rows_->size(); }
    auto begin() const { return rows_->begin(); }
    auto end() const { return rows_->end(); }
    const GenerationStatistics& front() const { return rows_->front(); }
    const GenerationStatistics& operator[](std::size_t island) const { return (*rows_)[island]; }

  private:
    std::shared_ptr<const std::vector<GenerationStatistics>> rows_;
};

/// Per island, by id: to whom of the first generation the first parents of its organisms lead back, from island to
/// island too; those are numbered from 0, island after island. No part of the state; none: nobody knows.
using Founders = std::vector<std::vector<std::uint32_t>>;

class World {
  public:
    /// Generations of statistics kept in memory, as far as they come to so many rows, one per island; older ones are
    /// forgotten.
    static constexpr std::size_t history_generations_kept = 10'000, history_rows_kept = 131'072;
    static constexpr std::size_t history_generations_kept_of(std::size_t island_count) {
        return std::min(history_generations_kept, std::max<std::size_t>(history_rows_kept / island_count, 1));
    }
    /// Of how many generations before its first a fork knows the statistics, at most.
    static constexpr std::size_t history_generations_inherited = 1'000;
    /// Of ended generations, oldest first.
    using History = std::deque<GenerationRows>;

    /// The first generation stands ready at (1, 0).
    ///
    /// parameters        valid.
    /// first_population  that a world with these parameters can have; nullptr: it is drawn.
    /// schedule          whose generation 1 is in the parameters.
    World(const parameters::Parameters& parameters, base::Seed seed, FirstPopulation first_population = {},
          parameters::Schedule schedule = {});

    /// At the beginning of a generation of a run, from where it goes on as that run did.
    ///
    /// born              what bred it, shape (islands): opening.parameters.active.island_count.
    /// history           statistics of the generations before it, as far as they are known.
    /// first_population  with which the run began, and begins if it is reset; nullptr: it is drawn.
    /// founders          of who was born; those of the first generation are known anyway.
    World(base::Seed seed, const Opening& opening, std::vector<evolution::NextGeneration> born, History history,
          base::Executor& executor, FirstPopulation first_population = {}, Founders founders = {},
          parameters::Schedule schedule = {});

    /// Another world, as this one was at the first moment of its generation; with what was asked of it since, if this
    /// is still that moment.
    World at_its_opening(base::Executor& executor, bool with_what_was_asked_since = false) const;

    /// As much of the world as restore() needs to bring it here again.
    WorldState state(base::Executor& executor) const;
    /// What the islands of a state of this generation hold.
    std::vector<IslandShape> shapes() const;
    /// Brings a world that stands at the beginning of a generation to a later moment of it, from where it goes on as
    /// the one did whose state() this was. Refused, having changed nothing, if no such world can be in that state;
    /// whoever has the hash of the one that was compares.
    base::Result<void> restore(const WorldState& state, base::Executor& executor);

    /// With what the run begins if it is reset: the parameters last asked for, those that are scheduled as they are in
    /// generation 1. Refused if they do not go together.
    base::Result<parameters::Parameters> beginning() const;
    /// Begins the run again with its beginning(), its schedule, and the same first population if one was given, which a
    /// world with those parameters can have. Throws std::bad_alloc, having changed nothing, where memory does not
    /// suffice for the world beside the one that it replaces.
    void reset(base::Seed seed);

    /// One tick; before it, if a generation has ended, the breeding of the next. Not to be called while outcome() is
    /// not Running.
    void advance_tick(base::Executor& executor);

    /// Breeds the next generation and places it, as advance_tick would; does nothing if none has ended. Where
    /// shuffle_fitness holds, the shuffled fitness decides who migrates, stays and breeds, and nothing else.
    void turn_over(base::Executor& executor);

    const Moment& moment() const { return moment_; }
    base::Seed seed() const { return seed_; }
    base::StateHash hash() const { return hash_; }
    const parameters::ParameterSet& parameters() const { return parameters_; }
    const FirstPopulation& first_population() const { return first_population_; }
    const parameters::Schedule& schedule() const { return schedule_; }
    /// In order of their ids.
    const std::vector<parameters::PlannedChange>& planned() const { return planned_; }
    /// Has it made at its moment, which is_to_come(); what is due at the same moment is made in order of ids, after
    /// what is scheduled. Gives it an id, and returns that.
    std::uint64_t plan(parameters::PlannedChange change);
    /// What waited under that id does so no more; nothing if there is none.
    std::optional<parameters::PlannedChange> cancel(std::uint64_t id);
    bool is_to_come(const parameters::PlannedMoment& moment) const;
    /// Of a world that was brought to a later moment than where things were planned: plans them again under the same
    /// ids, and forgets those that were due by now, which have been made there.
    std::uint64_t add_planned(parameters::PlannedChange change);
    void forget_what_was_due();
    /// Takes a set that assign() has made from parameters().requested; each parameter holds from when its effect says.
    void request_parameters(const parameters::Parameters& requested);

    bool generation_over() const { return generation_over_; }
    /// The criterion that holds now that a generation is over, by the parameters that hold now; else Running.
    evolution::Outcome outcome() const;

    /// Of the present generation; who was born in it is known by the islands.
    const Opening& opening() const { return opening_; }

    std::span<const Island> islands() const { return islands_; }
    /// Of the present generation; empty if this world began with a later one than the first, and was not told.
    const Founders& founders() const { return founders_; }
    /// Of one island.
    std::span<const std::uint32_t> founders(const Island& island) const;
    /// false while the fitness is a function of the chromosome alone: the islands hold no bodies.
    bool has_bodies() const { return parameters_.active.fitness == parameters::FitnessFunction::Life; }
    /// What organisms [ids.begin, ids.end) of an island are about to do, from what lies there now; None for the dead,
    /// for all where the generation is over, and where there are no bodies.
    std::vector<Intention> intentions(const Island& island, base::Range ids) const;
    /// Organisms alive on all islands.
    std::uint64_t alive_count() const;

    const History& history() const { return history_; }
    /// Forgets the statistics that a fork does not inherit, and what waits in its origin.
    void become_fork();
    /// Of the generation that is over: per island, by id. Empty while none is.
    std::span<const std::vector<double>> fitness() const { return fitness_; }

    /// What happened since this was last called, in order.
    std::vector<EventKind> take_events() { return std::exchange(events_, {}); }

  private:
    World(parameters::ParameterSet parameters, base::Seed seed, FirstPopulation first_population,
          parameters::Schedule schedule);
    void begin_run();
    void make_islands();
    /// What is planned for the generation that is about to be bred.
    void make_planned_for(std::uint64_t generation);
    /// What is planned for the tick that is over.
    void make_planned_now();
    /// Has all of it asked for, or tells why not.
    ///
    /// id, by  as in ParametersChanged.
    void make_planned(std::span<const parameters::Assignment> changes,
                      const base::Result<parameters::Parameters>& requested, std::uint64_t id, const std::string& by);
    void begin_generation(std::vector<evolution::NextGeneration> bred, base::Executor& executor);
    /// Whether a generation is over after `generation_tick`, with so many alive.
    bool ends(std::uint64_t generation_tick, std::uint64_t alive) const;
    void end_generation(base::Executor& executor);
    void find_fitness(base::Executor& executor);
    /// Takes the statistics of the generation that is over.
    void close_generation(const std::vector<GenerationStatistics>& statistics);
    /// What breeds: the chromosomes of the generation that is over, or, where migrants came, `migrated`.
    std::vector<const evolution::GeneMatrix*> parents(std::vector<evolution::GeneMatrix>& migrated);
    /// Of who has been bred, or is the first.
    void find_founders(const std::vector<evolution::NextGeneration>& bred);
    void update_hash();

    base::Seed seed_;
    parameters::ParameterSet parameters_;
    FirstPopulation first_population_;
    parameters::Schedule schedule_;
    std::vector<parameters::PlannedChange> planned_; // in order of ids
    std::uint64_t planned_count_ = 0;                // of this run, so far
    Moment moment_;
    bool generation_over_ = false;
    base::StateHash hash_;
    std::vector<Island> islands_;
    Opening opening_;
    History history_;
    std::vector<EventKind> events_;
    Founders founders_;
    std::vector<std::vector<double>> fitness_; // of the generation that is over: per island, by id
    evolution::Progress progress_;
    std::vector<std::uint8_t> died_out_; // in the present tick, per island; working memory, kept warm
};

} // namespace evod::simulation
