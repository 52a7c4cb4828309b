// World: one experiment with its parameters, seed, islands and history. Simulated time advances only in advance_tick().
//
// A moment is (generation, tick within it). The last tick of a generation ends it: statistics are computed, and the
// world keeps its organisms, dead and alive. The next advance_tick() breeds the next generation and performs its first
// tick. Breeding therefore uses the parameters in effect at that time.
//
// The scheduled values of a generation are requested before that generation is bred. Values with Effect::NextGeneration
// take effect at once, so they apply to its population size and to the contents of its islands. Values with
// Effect::NextTick take effect in its first tick, so it is still bred with their previous values. At the first moment
// of a generation, the active parameters are therefore those that bred it.
//
// If the fitness comes from clients, the generation ends in two steps. After its last tick the world awaits fitness and
// cannot advance. When clients have rated all islands (rating.h), statistics are computed, and the generation is over.
//
// A world advances and changes its islands through Islands, which may hold them in this process or in several.
//
// Threads      called on the simulation thread; work is passed to the given executor.
// Determinism  the state after any tick is a pure function of (parameters, schedule, seed, changes at their ticks).
//              Changes are those of parameters, entities that were placed or removed, and fitness from clients.
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"
#include "server/base/result.h"
#include "server/base/state_hash.h"
#include "server/evolution/termination.h"
#include "server/parameters/model_parameters.h"
#include "server/parameters/schedule.h"
#include "server/simulation/changes.h"
#include "server/simulation/commands.h"
#include "server/simulation/events.h"
#include "server/simulation/islands.h"
#include "server/simulation/run_parameters.h"
#include "server/simulation/world_state.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace evod::simulation {

/// The state of a world at the beginning of a generation, before its first tick.
struct Opening {
    Moment moment; // its generation_tick is 0
    parameters::ParameterSet parameters;
    evolution::Progress progress; // progress of the run over the previous generations
};

class World {
  public:
    /// Creates the first generation, at moment (1, 0).
    ///
    /// parameters        the parameters of generation 1; must be valid.
    /// first_population  the chromosomes of generation 1, valid for these parameters; nullptr: drawn from the seed.
    /// schedule          the schedule of the run; must have the values of `parameters` in generation 1.
    /// maker             divides the islands among processes; nullptr: they are all in this process. It must outlive
    ///                   the world.
    ///
    /// Throws std::bad_alloc if memory does not suffice.
    World(const parameters::Parameters& parameters, base::Seed seed, FirstPopulation first_population = {},
          parameters::Schedule schedule = {}, IslandsMaker* maker = nullptr)
        : World{parameters::ParameterSet::all_in_effect(parameters), seed, std::move(first_population),
                std::move(schedule), maker} {}

    /// Creates a world at the beginning of a generation of an existing run. It continues exactly as that run did.
    ///
    /// bred              the organisms of the generation; shape (opening.parameters.active.island_count). The founders
    ///                   are not needed for the first generation.
    /// history           statistics of the previous generations that are available.
    /// first_population  the first population of the run, for resets; nullptr: drawn from the seed.
    World(base::Seed seed, const Opening& opening, BredIslands bred, History history, base::Executor& executor,
          FirstPopulation first_population = {}, parameters::Schedule schedule = {}, IslandsMaker* maker = nullptr);

    /// Returns a copy of this world, without its events.
    ///
    /// maker  as for a new world.
    World copy(base::Executor& executor, IslandsMaker* maker = nullptr) const;
    /// Returns a copy of this world as it was at the first moment of its generation: as the generation was bred, before
    /// its first tick and without the commands since. Its islands are divided like those of this one.
    World at_its_opening(base::Executor& executor) const;

    /// Returns the data that restore() needs to bring a world to this moment.
    WorldState state(base::Executor& executor) const;
    /// Returns the number of entities on each island. Every state of this generation has these numbers.
    std::vector<IslandShape> shapes() const;
    /// Brings a world at the beginning of a generation to a later moment of that generation. It then continues as the
    /// world on which state() was called. Refused, with nothing changed, if the state is impossible. Does not check the
    /// state hash; a caller that knows it compares it with hash().
    base::Result<void> restore(const WorldState& state, base::Executor& executor);

    /// Returns the parameters that the run begins with after a reset: the requested parameters, with the schedule's
    /// values of generation 1. Returns a refusal if they are not valid together.
    ///
    /// listed_genes  the list of the free genes from now on; nullopt: the present list.
    base::Result<parameters::Parameters>
    beginning(const std::optional<evolution::FreeGenes>& listed_genes = std::nullopt) const;
    /// Returns the world with which the run restarts after a reset: with the parameters of beginning(), the same
    /// schedule and, if one was given, the same first population. That population must be valid for these parameters.
    /// Throws std::bad_alloc if memory does not suffice for both worlds.
    ///
    /// listed_genes  as for beginning().
    /// maker         as for a new world.
    World restarted(base::Seed seed, const std::optional<evolution::FreeGenes>& listed_genes = std::nullopt,
                    IslandsMaker* maker = nullptr) const;

    /// Performs one tick. If a generation has ended, first breeds the next. Requires outcome() to be Running, and the
    /// world not to await fitness.
    void advance_tick(base::Executor& executor) { advance(moment_.tick + 1, executor); }

    /// Performs ticks up to and including `tick`, but not beyond the end of the generation that the first of them
    /// belongs to. Gives the same state as that many calls of advance_tick(). Processes that share the world exchange
    /// results only once, and once more for each tick with planned changes.
    void advance(std::uint64_t tick, base::Executor& executor);

    /// Breeds and places the next generation, as advance_tick() would; does nothing if no generation has ended.
    void breed_next_generation(base::Executor& executor);

    const Moment& moment() const { return moment_; }
    base::Seed seed() const { return seed_; }
    base::StateHash hash() const { return hash_; }
    const parameters::ParameterSet& parameters() const { return parameters_.set(); }
    const FirstPopulation& first_population() const { return first_population_; }
    const parameters::Schedule& schedule() const { return parameters_.schedule(); }
    /// The planned changes, in order of id.
    const std::vector<parameters::PlannedChange>& planned() const { return parameters_.planned(); }
    /// Adds a planned change under a new id and returns the id. The moment of the change must be in the future
    /// (is_in_future()). At that moment, changes are applied in order of id, after the values of the schedule.
    std::uint64_t plan(parameters::PlannedChange change) { return parameters_.plan(std::move(change)); }
    /// Cancels a planned change and returns it; nullopt if there is none with that id.
    std::optional<parameters::PlannedChange> cancel(std::uint64_t id) { return parameters_.cancel(id); }
    bool is_in_future(const parameters::PlannedMoment& moment) const { return is_after(moment, moment_); }
    /// For replays: restores the planned changes in a world that starts in the middle of a run. The caller has passed
    /// every change that the run planned before that moment to plan(), in order, so that each has its original id. This
    /// function removes the changes whose moment is not in the future: the run has already applied them.
    void drop_due_changes() { parameters_.drop_due(moment_); }
    /// Sets the requested parameters, which assign() has computed from parameters().requested. Each takes effect at the
    /// time that its Effect states.
    ///
    /// by  the client that requested them
    void request_parameters(const parameters::RequestedParameters& requested, const base::Actor& by = {}) {
        parameters_.request(requested, generation_of_changes(), by);
    }

    /// Places entities between two ticks, or removes them. check() must have accepted the command (entities.h). Returns
    /// the ids of the entities.
    EntityIds place(const PlaceEntities& command);
    EntityIds remove(const RemoveEntities& command);
    /// Sets fitness from a client. check() must have accepted the command (rating.h). After the last missing number,
    /// the generation is over.
    void set_fitness(const SetFitness& command);
    /// Whether this is the first moment of a generation, and no command has changed the world since.
    bool is_as_begun() const;

    bool generation_over() const { return generation_over_; }
    /// Whether the last tick of the generation has passed, but clients have not rated all islands yet.
    bool awaits_fitness() const { return !generation_over_ && !ratings_.empty(); }
    /// Whether the last tick of the generation has passed.
    bool is_after_last_tick() const { return generation_over_ || awaits_fitness(); }
    /// Whether clients have given the fitness of all organisms of an island.
    bool is_rated(std::uint32_t island) const;
    /// Returns the termination criterion that holds with the active parameters at the end of a generation; during a
    /// generation, Running.
    evolution::Outcome outcome() const;

    /// The opening of the present generation. Island::bred() contains its organisms.
    const Opening& opening() const { return opening_; }

    const Islands& islands() const { return *islands_; }
    std::uint32_t island_count() const { return static_cast<std::uint32_t>(islands_->size()); }
    const Island& island(std::size_t island) const { return islands_->island(island); }
    /// Whether several processes hold the islands.
    bool is_shared() const { return islands_->maker() != nullptr; }
    /// The number of organisms of this generation on an island, with those that were placed.
    std::uint32_t organism_count(std::size_t island) const { return islands_->summaries()[island].organism_count; }
    /// Returns the organisms of all islands as the generation began, without those that were placed.
    BredIslands bred() const { return islands_->bred(); }
    /// Returns the outcome of the generation on every island. The generation must be over.
    std::vector<IslandOutcome> outcomes() const;
    /// false if the fitness needs only the chromosomes: the islands contain no bodies.
    bool has_bodies() const { return parameters::has_bodies(parameters_.active()); }
    /// Predicts what organisms [ids.begin, ids.end) of an island will do next, if no item reappears before that. The
    /// choice is None for dead organisms, at the end of a generation, and if there are no bodies.
    std::vector<Intention> intentions(const Island& island, base::Range ids) const;
    /// Predicts the activations of an organism's network in the next tick, in the same way; nullopt if the organism has
    /// no network or does nothing.
    std::optional<Activations> activations(const Island& island, std::uint32_t id) const;
    /// The number of living organisms on all islands.
    std::uint64_t alive_count() const;

    /// The statistics of the ended generations, at most history_generations_kept_of() of them.
    const History& history() const { return history_; }
    /// The changes of parameters in this run, oldest first.
    const Changes& changes() const { return parameters_.changes(); }
    /// For replays: sets the changes of the run before the present moment.
    void set_past_changes(Changes changes) { parameters_.set_past_changes(std::move(changes)); }
    /// Drops the statistics that a fork does not inherit, the changes of the original, and those planned for it.
    void become_fork();
    /// The fitness from clients, per island, by id: after the last tick of a generation the numbers given so far;
    /// otherwise empty.
    std::span<const Rating> ratings() const { return ratings_; }

    /// Returns and removes the events since the last call, oldest first.
    std::vector<EventKind> take_events() { return std::exchange(events_, {}); }

  private:
    World(const parameters::ParameterSet& set, base::Seed seed, FirstPopulation first_population,
          parameters::Schedule schedule, IslandsMaker* maker);
    /// A copy with other islands, without events.
    World(const World& original, std::unique_ptr<Islands> islands);
    /// To be called when the islands have begun a generation, at its first moment.
    void open();
    /// The routes on which organisms of a species migrate now. `parameters` are those of the species.
    std::vector<evolution::MigrationRoute> routes_of(Species species, const parameters::Parameters& parameters) const;
    /// Whether every organism has died. With births: whether no prey is left or, with stop_at_extinction, no predator.
    bool has_died_out() const;
    /// The generation in which a change of parameters is counted now.
    std::uint64_t generation_of_changes() const { return moment_.generation + (is_after_last_tick() ? 1 : 0); }
    /// The last tick of a generation with bodies, unless all organisms die before.
    std::uint64_t last_tick() const;
    /// Returns whether a generation ends after `generation_tick` if `alive` organisms are then alive.
    bool ends(std::uint64_t generation_tick, std::uint64_t alive) const;
    /// Ends a generation whose last tick has passed and whose fitness is known.
    void finish_generation(base::Executor& executor);
    /// Records the statistics of the ended generation.
    void close_generation(const std::vector<GenerationStatistics>& statistics);
    void update_hash();

    base::Seed seed_;
    RunParameters parameters_;
    FirstPopulation first_population_;
    Moment moment_;
    bool generation_over_ = false;
    base::StateHash hash_;
    std::unique_ptr<Islands> islands_;
    Opening opening_;
    History history_;
    std::vector<EventKind> events_;
    std::vector<Rating> ratings_;
    evolution::Progress progress_;
};

} // namespace evod::simulation
