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
// Several processes can share a world: each simulates some of its islands (sharing.h). Code that uses the world on rank 0
// need not know it: the world has the other processes do their part of every call.
//
// Threads      called on the simulation thread; work is passed to the given executor.
// Determinism  the state after any tick is a pure function of (parameters, schedule, seed, changes at their ticks).
//              Changes are those of parameters, entities that were placed or removed, and fitness from clients. It does
//              not depend on how islands are shared.
#pragma once

#include "server/base/executor.h"
#include "server/base/packing.h"
#include "server/base/random.h"
#include "server/base/result.h"
#include "server/base/state_hash.h"
#include "server/evolution/migration.h"
#include "server/evolution/termination.h"
#include "server/parameters/parameters.h"
#include "server/parameters/schedule.h"
#include "server/simulation/changes.h"
#include "server/simulation/commands.h"
#include "server/simulation/events.h"
#include "server/simulation/island.h"
#include "server/simulation/share.h"
#include "server/simulation/sharing.h"
#include "server/simulation/statistics.h"
#include "server/simulation/world_state.h"

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace evod::simulation {

/// The state of a world at the beginning of a generation, before its first tick.
struct Opening {
    Moment moment; // its generation_tick is 0
    parameters::ParameterSet parameters;
    evolution::Progress progress; // progress of the run over the previous generations
};

/// The statistics of an ended generation, one entry per island. They are immutable, and copies share them.
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

/// For each island, the founder of each organism, by id: the ancestor in the first generation that is found by
/// following first parents, also across islands. Founders are numbered from 0, island after island. Not part of the
/// state; empty if unknown. The founder of an organism that was placed is `no_founder`.
using Founders = std::vector<std::vector<std::uint32_t>>;
constexpr std::uint32_t no_founder = ~0U;

/// The organisms with which a generation began.
struct BredIslands {
    std::vector<evolution::NextGeneration> islands; // one per island
    Founders founders;
};

/// The outcome of a generation on one island. Every vector is indexed by organism id.
struct IslandOutcome {
    std::vector<double> fitness;
    std::vector<std::uint32_t> lived_ticks; // ticks until death; 0 for an organism that lived to the end
    std::vector<CauseOfDeath> cause;
    friend bool operator==(const IslandOutcome&, const IslandOutcome&) = default;
};

class World {
  public:
    /// The maximum number of generations, and of rows, whose statistics are kept in memory. A generation has one row
    /// per island, whose size grows with the number of genes, so with many islands or genes fewer generations are kept.
    /// The oldest are dropped first.
    static constexpr std::size_t history_generations_kept = 10'000, history_rows_kept = 131'072;
    static constexpr std::size_t history_generations_kept_of(std::size_t island_count,
                                                             std::size_t gene_count = evolution::body_gene_count) {
        const std::size_t rows = history_rows_kept * evolution::body_gene_count / gene_count;
        return std::min(history_generations_kept, std::max<std::size_t>(rows / island_count, 1));
    }
    /// The maximum number of generations whose statistics this world keeps.
    std::size_t history_generations_kept_here() const {
        return history_generations_kept_of(islands_.size(), evolution::gene_count(parameters_.active));
    }
    /// The maximum number of previous generations whose statistics a fork keeps.
    static constexpr std::size_t history_generations_inherited = 1'000;
    /// The ended generations, oldest first.
    using History = std::deque<GenerationRows>;

    /// Creates the first generation, at moment (1, 0).
    ///
    /// parameters        the parameters of generation 1; must be valid.
    /// first_population  the chromosomes of generation 1, valid for these parameters; nullptr: drawn from the seed.
    /// schedule          the schedule of the run; must have the values of `parameters` in generation 1.
    /// leader            orders the other processes to share the world; nullptr: it is not shared.
    ///
    /// Throws std::bad_alloc if memory does not suffice in one of the processes that share the world.
    World(const parameters::Parameters& parameters, base::Seed seed, FirstPopulation first_population = {},
          parameters::Schedule schedule = {}, Leader* leader = nullptr);

    /// Creates a world at the beginning of a generation of an existing run. It continues exactly as that run did.
    ///
    /// born              the organisms of the generation; shape (opening.parameters.active.island_count).
    /// history           statistics of the previous generations that are available.
    /// first_population  the first population of the run, for resets; nullptr: drawn from the seed.
    /// founders          founders of the organisms in `born`; not needed for the first generation.
    World(base::Seed seed, const Opening& opening, std::vector<evolution::NextGeneration> born, History history,
          base::Executor& executor, FirstPopulation first_population = {}, Founders founders = {},
          parameters::Schedule schedule = {}, Leader* leader = nullptr);

    /// Returns a copy of this world, without its events. A constructor cannot copy a shared world.
    ///
    /// leader  as for a new world.
    World copy(base::Executor& executor, Leader* leader = nullptr) const;
    /// Returns a copy of this world as it was at the first moment of its generation: as the generation was bred, before
    /// its first tick and without the commands since. It is shared like this one.
    World at_its_opening(base::Executor& executor) const;

    /// Returns the data that restore() needs to bring a world to this moment.
    WorldState state(base::Executor& executor) const;
    /// Returns the number of entities on each island. Every state of this generation has these numbers.
    std::vector<IslandShape> shapes() const;
    /// Brings a world at the beginning of a generation to a later moment of that generation. It then continues as the
    /// world on which state() was called. Refused, with nothing changed, if the state is impossible. Does not check the
    /// state hash; a caller that knows it compares it with hash(). The world must not be shared.
    base::Result<void> restore(const WorldState& state, base::Executor& executor);

    /// Returns the parameters that the run begins with after a reset: the requested parameters, with the schedule's
    /// values of generation 1. Returns a refusal if they are not valid together.
    base::Result<parameters::Parameters> beginning() const;
    /// Returns the world with which the run restarts after a reset: with the parameters of beginning(), the same
    /// schedule and, if one was given, the same first population. That population must be valid for these parameters.
    /// Throws std::bad_alloc if memory does not suffice for both worlds.
    ///
    /// leader  as for a new world.
    World restarted(base::Seed seed, Leader* leader = nullptr) const;

    /// Performs one tick. If a generation has ended, first breeds the next. Requires outcome() to be Running, and the
    /// world not to await fitness.
    void advance_tick(base::Executor& executor) { advance(moment_.tick + 1, executor); }

    /// Performs ticks up to and including `tick`, but not beyond the end of the generation that the first of them
    /// belongs to. Gives the same state as that many calls of advance_tick(). Processes that share the world exchange
    /// results only once; extinctions are then reported after the changes of parameters in these ticks.
    void advance(std::uint64_t tick, base::Executor& executor);

    /// Breeds and places the next generation, as advance_tick() would; does nothing if no generation has ended. If
    /// shuffle_fitness is on, the shuffled fitness decides migration, survival and breeding, and nothing else.
    void turn_over(base::Executor& executor);

    const Moment& moment() const { return moment_; }
    base::Seed seed() const { return seed_; }
    base::StateHash hash() const { return hash_; }
    const parameters::ParameterSet& parameters() const { return parameters_; }
    const FirstPopulation& first_population() const { return first_population_; }
    const parameters::Schedule& schedule() const { return schedule_; }
    /// The planned changes, in order of id.
    const std::vector<parameters::PlannedChange>& planned() const { return planned_; }
    /// Adds a planned change under a new id and returns the id. The moment of the change must be in the future
    /// (is_in_future()). At that moment, changes are applied in order of id, after the values of the schedule.
    std::uint64_t plan(parameters::PlannedChange change);
    /// Cancels a planned change and returns it; nullopt if there is none with that id.
    std::optional<parameters::PlannedChange> cancel(std::uint64_t id);
    bool is_in_future(const parameters::PlannedMoment& moment) const;
    /// For replays: restore the planned changes in a world that starts in the middle of a run. The caller passes every
    /// change that the run planned before that moment to add_planned(), in order, so that each gets its original id. It
    /// then calls drop_due_changes(), which removes the changes whose moment is not in the future: the run has already
    /// applied them.
    std::uint64_t add_planned(parameters::PlannedChange change);
    void drop_due_changes();
    /// Sets the requested parameters, which assign() has computed from parameters().requested. Each takes effect at the
    /// time that its Effect states.
    ///
    /// by  the client that requested them
    void request_parameters(const parameters::RequestedParameters& requested, const std::string& by = {});

    /// Places entities between two ticks, or removes them. check() must have accepted the command (entities.h). Returns
    /// the ids of the entities.
    EntityIds place(const PlaceEntities& command);
    EntityIds remove(const RemoveEntities& command);
    /// Sets fitness from a client. check() must have accepted the command (rating.h). After the last missing number, the
    /// generation is over.
    void set_fitness(const SetFitness& command);
    /// Whether this is the first moment of a generation, and no command has changed the world since.
    bool is_as_begun() const;

    bool generation_over() const { return generation_over_; }
    /// Whether the last tick of the generation has passed, but clients have not rated all islands yet.
    bool awaits_fitness() const { return !generation_over_ && !fitness_.empty(); }
    /// Whether the last tick of the generation has passed.
    bool is_after_last_tick() const { return generation_over_ || awaits_fitness(); }
    /// Whether an island has the fitness of all its organisms.
    bool is_rated(std::uint32_t island) const;
    /// Returns the termination criterion that holds with the active parameters at the end of a generation; during a
    /// generation, Running.
    evolution::Outcome outcome() const;

    /// The opening of the present generation. Island::bred() contains its organisms.
    const Opening& opening() const { return opening_; }

    std::uint32_t island_count() const { return static_cast<std::uint32_t>(islands_.size()); }
    /// Returns an island in its present state. If another process simulates it, this is a copy, which is brought here
    /// at the first call after a tick, and is valid until the next tick.
    const Island& island(std::size_t island) const { return is_mine(island) ? islands_[island] : brought(island).now; }
    /// Brings several islands here at once, so that island() returns them without waiting.
    void bring(std::span<const std::uint32_t> islands) const;
    /// The islands of a world; those that other processes simulate are empty.
    std::span<const Island> islands() const { return islands_; }
    /// The islands that this process simulates: [begin, end).
    base::Range share() const { return share_; }
    bool is_shared() const { return sharing_.is_shared(); }
    /// The number of organisms of this generation on an island, with those that were placed.
    std::uint32_t organism_count(std::size_t island) const;
    /// The founders of the organisms in Island::born(). Empty if this world began with a later generation and received no
    /// founders. Those of islands that other processes simulate are not here.
    const Founders& founders() const { return founders_; }
    /// The founders of the organisms of one island, which island() has returned.
    std::span<const std::uint32_t> founders(const Island& island) const;
    /// Returns the organisms of all islands as the generation began, without those that were placed.
    BredIslands bred() const;
    /// Returns the outcome of the generation on every island. The generation must be over.
    std::vector<IslandOutcome> outcomes() const;
    /// Returns the live statistics of every island.
    std::vector<LiveStatistics> live_statistics() const;
    /// false if the fitness needs only the chromosomes: the islands contain no bodies.
    bool has_bodies() const { return parameters::has_bodies(parameters_.active); }
    /// Predicts what organisms [ids.begin, ids.end) of an island will do next, if no item reappears before that. The
    /// choice is None for dead organisms, at the end of a generation, and if there are no bodies.
    std::vector<Intention> intentions(const Island& island, base::Range ids) const;
    /// Predicts the activations of an organism's network in the next tick, in the same way; nullopt if the organism has
    /// no network or does nothing.
    std::optional<Activations> activations(const Island& island, std::uint32_t id) const;
    /// The number of living organisms on all islands.
    std::uint64_t alive_count() const;

    const History& history() const { return history_; }
    /// The changes of parameters in this run, oldest first.
    const Changes& changes() const { return changes_; }
    /// For replays: sets the changes of the run before the present moment.
    void set_past_changes(Changes changes) { changes_ = std::move(changes); }
    /// Drops the statistics that a fork does not inherit, the changes of the original, and those planned for it.
    void become_fork();
    /// The fitness in the ended generation, per island, by id. Empty during a generation. While the world awaits fitness,
    /// each island has the numbers given so far.
    std::span<const std::vector<double>> fitness() const { return fitness_; }

    /// Returns and removes the events since the last call, oldest first.
    std::vector<EventKind> take_events() { return std::exchange(events_, {}); }

    // For processes that follow (sharing.h). They read the arguments of the order.
    static World created(base::Unpacker& order, base::Exchange& exchange);
    static World opened(base::Unpacker& order, base::Exchange& exchange, base::Executor& executor);
    void restore_share(base::Unpacker& order, base::Executor& executor);
    /// Sends those of the islands that this process simulates to rank 0.
    void send_islands(std::span<const WantedIsland> islands) const;
    /// Sets the planned changes.
    ///
    /// planned_count  number of changes planned in this run so far.
    void set_planned(std::vector<parameters::PlannedChange> planned, std::uint64_t planned_count);

  private:
    World(parameters::ParameterSet parameters, base::Seed seed, FirstPopulation first_population,
          parameters::Schedule schedule, Sharing sharing);
    World(base::Seed seed, const Opening& opening, std::vector<evolution::NextGeneration> born, History history,
          base::Executor& executor, FirstPopulation first_population, Founders founders, parameters::Schedule schedule,
          Sharing sharing);
    /// Orders the other processes to create their share.
    void order_creation() const;
    void order_opening(const std::vector<evolution::NextGeneration>& born, const Founders& founders) const;
    /// Orders the other processes to restore their share, and restores that of this process.
    void restore_shared(const WorldState& state, base::Executor& executor);
    /// Restores a state that has been checked. The islands of other processes are not read.
    void apply_state(const WorldState& state, base::Executor& executor);
    /// A copy of an island that another process simulates.
    struct BroughtIsland {
        Island begun; // as its generation began
        Island now;
        std::uint64_t tick; // `now` is its state after this tick of the run
        std::vector<std::uint32_t> founders;
    };
    BroughtIsland& brought(std::size_t island) const;
    /// Reads what send_islands() has sent.
    void receive(const WantedIsland& wanted, base::Unpacker& unpacker) const;
    EntityIds place_here(Island& island, const PlaceEntities& command);
    void turn_over_share(base::Executor& executor);
    /// Returns an island that this process may change: its own, or a copy that has been brought; otherwise nullptr.
    Island* island_here(std::size_t island);
    void begin_run();
    parameters::Parameters parameters_of_next_tick() const;
    void make_islands();
    /// Adds the requested parameters that differ from `requested` to the changes of the run.
    void record_change(const parameters::RequestedParameters& requested, const std::string& by);
    /// Applies the changes planned for the generation that is about to be bred.
    void apply_planned_for(std::uint64_t generation);
    /// Applies the changes planned for the tick that has just ended.
    void apply_planned_now();
    /// Requests the parameters in `requested`, which contain `changes`. If `requested` is a refusal, drops the changes
    /// and reports why.
    ///
    /// id, by  ParametersChanged::planned and ParametersChanged::by.
    void apply_planned(std::span<const parameters::Assignment> changes,
                       const base::Result<parameters::RequestedParameters>& requested, std::uint64_t id,
                       const std::string& by);
    /// Begins a generation with the organisms that make() returns. If memory does not suffice for them in one of the
    /// processes that share the world, throws TooLargeToShare in all of them.
    template <class Make>
    void begin_generation(Make&& make, base::Executor& executor);
    /// Returns whether a generation ends after `generation_tick` if `alive` organisms are then alive.
    bool ends(std::uint64_t generation_tick, std::uint64_t alive) const;
    bool is_fitness_external() const { return parameters_.active.fitness == parameters::FitnessFunction::External; }
    /// Ends the generation after its last tick, or makes the world await fitness.
    void end_generation(base::Executor& executor);
    /// Ends a generation whose fitness is known.
    void finish_generation(base::Executor& executor);
    void find_fitness(base::Executor& executor);
    /// Performs one tick on the islands of this process. Returns the number of living organisms on them.
    std::uint64_t advance_share(base::Executor& executor);
    /// Brings all processes to the tick that the last of them has reached, and exchanges summaries and extinctions.
    void meet(base::Executor& executor);
    /// Throws TooLargeToShare in all processes if `fits` is false in one of them.
    void exchange_summaries(bool fits = true);
    std::vector<IslandSummary> summaries_of_share() const;
    bool is_mine(std::size_t island) const { return share_.begin <= island && island < share_.end; }
    /// Records the statistics of the ended generation.
    void close_generation(const std::vector<GenerationStatistics>& statistics);
    /// Returns the chromosomes to breed from, one matrix per island. If migrants arrive, these are new matrices, which
    /// are stored in `migrated`; otherwise they are the chromosomes of the ended generation.
    std::vector<const evolution::GeneMatrix*> parents(std::vector<evolution::GeneMatrix>& migrated);
    /// Sends the migrants of these routes, and writes those that arrive on the islands of this process.
    void migrate(std::span<const evolution::MigrationRoute> routes, std::vector<evolution::GeneMatrix>& migrated);
    /// Sets the founders of the organisms in `bred`.
    void find_founders(const std::vector<evolution::NextGeneration>& bred);
    void update_hash();

    base::Seed seed_;
    parameters::ParameterSet parameters_;
    FirstPopulation first_population_;
    parameters::Schedule schedule_;
    std::vector<parameters::PlannedChange> planned_; // sorted by id
    std::uint64_t planned_count_ = 0;                // number of changes planned in this run so far
    Moment moment_;
    bool generation_over_ = false;
    base::StateHash hash_;
    std::vector<Island> islands_;
    Sharing sharing_;
    base::Range share_{0, 0};
    std::vector<IslandSummary> summaries_; // of all islands, as other processes have reported them; empty if not shared
    mutable std::map<std::size_t, BroughtIsland> brought_; // of this generation, by index; only on rank 0
    Opening opening_;
    History history_;
    Changes changes_;
    std::vector<EventKind> events_;
    Founders founders_;
    std::vector<std::vector<double>> fitness_; // fitness in the ended generation: per island, by id
    evolution::Progress progress_;
    // Per island: whether its last organism died in this tick. Kept between ticks to reuse the memory.
    std::vector<std::uint8_t> died_out_;
    struct DiedOut {
        std::uint64_t tick;
        std::uint32_t island;
    };
    std::vector<DiedOut> died_out_since_meeting_; // used only if the world is shared
};

} // namespace evod::simulation
