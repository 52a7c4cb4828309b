// What each phase of a tick costs: the benchmark world at several populations, on one thread.
//
// The core asks no clock, so a tick is put together here from the same parts in the same order as Island::advance_tick,
// with a clock between them; its hash is compared with that of an island, so the two cannot drift apart. Where a tick
// goes over blocks of organisms, the clock is read between the parts of every block, for some 0.3 ns an organism and
// tick.
//
// Benchmarks are named PHASE/ORGANISMS; items_per_second is organism-ticks a second of that phase alone. "whole tick"
// is that of an island, by one clock around the same ticks. All phases of a population are measured in one loop.
#include "server/base/inline_executor.h"
#include "server/simulation/world.h"
#include "tests/bench/experiment.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace evod::bench {
namespace {

using namespace simulation;
using Clock = std::chrono::steady_clock;

enum Phase : std::size_t {
    NearPairsRenewed, // averaged over all ticks: sorted and listed now and then, put in order more seldom
    ItemsReappear,
    ChangesNoticed,
    Look,
    Choose,
    Accelerate,
    ResolveContacts,
    Move,
    Follow,
    Hash,
    FeedAndBury,
    WholeTick,
    phase_count
};
constexpr std::array<const char*, phase_count> phase_names = {"near pairs",
                                                              "items reappear",
                                                              "update perception",
                                                              "search for items",
                                                              "choose",
                                                              "accelerate and find contacts",
                                                              "resolve contacts",
                                                              "move",
                                                              "follow, find touched items",
                                                              "hash",
                                                              "feed and remove the dead",
                                                              "whole tick"};

constexpr std::uint32_t warm_up_ticks = 60, measured_ticks = 60; // as in workload_bench

struct Times {
    std::array<double, phase_count> s{};
    std::uint64_t organism_ticks = 0;
};

/// Gives what has passed since the last lap to a phase.
class Laps {
  public:
    explicit Laps(Times& times) : times_{times} {}
    void lap(Phase phase) {
        const Clock::time_point now = Clock::now();
        times_.s[phase] += std::chrono::duration<double>(now - last_).count();
        last_ = now;
    }

  private:
    Times& times_;
    Clock::time_point last_ = Clock::now();
};

/// An island without boxes, with its parts in reach; see Island for what they do.
class OpenIsland {
  public:
    /// At the start of its first generation.
    OpenIsland(const parameters::Parameters& parameters, const Island& start)
        : parameters_{parameters}
        , area_{start.area()}
        , chromosomes_{start.born().genes}
        , born_hash_{start.hash()}
        , bodies_{start.bodies()}
        , living_{start.living()}
        , food_{start.food()}
        , poison_{start.poison()}
        , key_{start.seed(), base::Purpose::Behaviour, start.index(), 1}
        , alive_count_{start.alive_count()} {
        body_of_.resize(bodies_.size());
        life_records_.begin_generation(bodies_.size());
        perception_.begin(bodies_, living_, food_, poison_);
        stepper_.near().invalidate();
    }

    base::StateHash hash() const { return hash_; }

    void advance_tick(Times& times) {
        ++tick_;
        times.organism_ticks += alive_count_;
        Laps laps{times};
        if (stepper_.near().stale(bodies_, boxes_)) {
            renew_near_pairs();
        }
        laps.lap(NearPairsRenewed);
        food_.reappear(tick_, {}, executor_);
        poison_.reappear(tick_, {}, executor_);
        laps.lap(ItemsReappear);
        perception_.notice_food(bodies_, stepper_.near(), living_, food_, executor_);
        perception_.notice_poison(bodies_, stepper_.near(), living_, poison_, executor_);
        laps.lap(ChangesNoticed);

        const BehaviourRules rules{.flee_rule = parameters_.flee_rule,
                                   .lookahead_s = static_cast<float>(parameters_.steering_lookahead_s),
                                   .certain_impulse = static_cast<float>(parameters_.flee_certain_impulse),
                                   .force_per_unit = static_cast<float>(parameters_.force_per_unit)};
        const std::size_t block_count = physics::block_count(bodies_.size());
        stepper_.begin(bodies_, boxes_, area_,
                       {.integration = physics::integration(physics::Integrator::SymplecticEuler, parameters_.tick_s,
                                                            physics::damping_rate(parameters_.damping)),
                        .restitution = static_cast<float>(parameters_.restitution),
                        .max_speed_px_s = static_cast<float>(parameters_.max_speed_px_s)});
        for (std::size_t block = 0; block < block_count; ++block) {
            act(rules, block, laps);
        }
        stepper_.collide(bodies_, boxes_, executor_);
        laps.lap(ResolveContacts);

        food_claims_.begin(block_count);
        poison_claims_.begin(block_count);
        dying_.resize(block_count);
        hash_ = {};
        for (std::size_t block = 0; block < block_count; ++block) {
            move(block, laps);
        }
        stepper_.finish(boxes_);
        laps.lap(Move);
        feed_and_remove_dead(block_count);
        hash_ += born_hash_ + food_.hash() + poison_.hash();
        laps.lap(FeedAndBury);
    }

  private:
    OrganismColumns columns() { return organism_columns(bodies_, living_, perception_, food_, poison_); }

    void renew_near_pairs() {
        physics::NearPairs& near = stepper_.near();
        near.sort(bodies_, boxes_, area_, executor_);
        if ((renewals_++ % 4 == 0 && bodies_.size() > 1024) || alive_count_ < bodies_.size() - bodies_.size() / 8) {
            const physics::Reordering reordering{near.strips().order(), spare_column_, executor_};
            bodies_.reorder(reordering);
            living_.reorder(reordering);
            perception_.reorder(reordering);
            near.follow_reordering(bodies_, executor_);
            for (std::size_t i = 0; i < bodies_.size(); ++i) {
                body_of_[bodies_.id[i]] = static_cast<std::uint32_t>(i);
            }
        }
        near.list(bodies_, boxes_, executor_);
    }

    void act(const BehaviourRules& rules, std::size_t block, Laps& laps) {
        const base::Range range = physics::circles_of_block(bodies_.size(), block);
        perception_.search(bodies_, living_, food_, poison_, range);
        laps.lap(Look);
        ChosenForces forces;
        live_and_choose(columns(), rules, key_, tick_, range, forces);
        laps.lap(Choose);
        stepper_.accelerate(bodies_, block, {forces.x.data(), forces.y.data()});
        laps.lap(Accelerate);
    }

    void move(std::size_t block, Laps& laps) {
        const base::Range range = physics::circles_of_block(bodies_.size(), block);
        stepper_.move(bodies_, block);
        laps.lap(Move);
        std::uint32_t food_indices[physics::circles_per_block], poison_indices[physics::circles_per_block];
        FoundIndices at_food{food_indices}, at_poison{poison_indices};
        organism_kernels().follow(columns(), range.begin, range.end, at_food, at_poison);
        food_claims_.find_touches(block, {at_food.indices, at_food.count}, bodies_, food_);
        poison_claims_.find_touches(block, {at_poison.indices, at_poison.count}, bodies_, poison_);
        laps.lap(Follow);
        std::uint32_t dying_indices[physics::circles_per_block];
        FoundIndices dying{dying_indices};
        const HashWords hash = organism_kernels().hash(columns(), organism_hash_kind, range.begin, range.end, dying);
        hash_ += base::StateHash{hash.low, hash.high};
        dying_[block].assign(dying_indices, dying_indices + dying.count);
        laps.lap(Hash);
    }

    void feed_and_remove_dead(std::size_t block_count) {
        food_claims_.award();
        poison_claims_.award();
        for (std::size_t block = 0; block < block_count; ++block) {
            for (const Touch& touch : food_claims_.touches(block)) {
                if (touch.gets_it) {
                    const float cap = health_cap(chromosomes_.col(static_cast<Eigen::Index>(touch.id)), parameters_);
                    change_health(
                        touch.body,
                        std::min(living_.health[touch.body] + static_cast<float>(parameters_.food_health), cap));
                    food_.add_to_hash(food_.set_due(touch.item, tick_));
                    ++life_records_.food_eaten[touch.id];
                }
            }
            for (const Touch& touch : poison_claims_.touches(block)) {
                if (touch.gets_it) {
                    change_health(touch.body, living_.health[touch.body] - static_cast<float>(parameters_.poison_harm));
                    poison_.add_to_hash(poison_.set_due(touch.item, tick_));
                    ++life_records_.poison_eaten[touch.id];
                }
            }
            for (const Touch& touch : poison_claims_.touches(block)) {
                if (touch.gets_it) {
                    bury_if_dying(touch.body, CauseOfDeath::Poisoned);
                }
            }
            for (const std::uint32_t body : dying_[block]) {
                bury_if_dying(body, CauseOfDeath::Starved);
            }
        }
        take_out(food_, food_claims_, block_count);
        take_out(poison_, poison_claims_, block_count);
    }

    static void take_out(Items& items, const ItemClaims& claims, std::size_t block_count) {
        for (std::size_t block = 0; block < block_count; ++block) {
            for (const Touch& touch : claims.touches(block)) {
                items.prefetch_place(touch.place);
            }
            for (const Touch& touch : claims.touches(block)) {
                if (touch.gets_it) {
                    items.take_out(touch.item, touch.place);
                }
            }
        }
    }

    void change_health(std::uint32_t body, float health) {
        hash_ -= hash_of_organism(bodies_, living_, body);
        living_.health[body] = health;
        hash_ += hash_of_organism(bodies_, living_, body);
    }

    void bury_if_dying(std::uint32_t body, CauseOfDeath cause) {
        if (bodies_.is_void(body) || living_.health[body] > 0) {
            return;
        }
        const std::uint32_t id = bodies_.id[body];
        life_records_.cause[id] = cause;
        life_records_.lived_ticks[id] = tick_;
        hash_ -= hash_of_organism(bodies_, living_, body);
        body_of_[id] = ~0u;
        bodies_.remove(body);
        perception_.remove(body);
        stepper_.near().remove(body);
        living_.health[body] = -std::numeric_limits<float>::infinity();
        --alive_count_;
    }

    parameters::Parameters parameters_;
    physics::Area area_;
    evolution::GeneMatrix chromosomes_;
    base::StateHash born_hash_, hash_;
    physics::Circles bodies_;
    physics::Boxes boxes_;
    LivingOrganisms living_;
    Items food_, poison_;
    base::RandomKey key_;
    Perception perception_;
    physics::Stepper stepper_;
    ItemClaims food_claims_, poison_claims_;
    LifeRecords life_records_;
    base::Column<std::uint32_t> body_of_, spare_column_;
    std::vector<std::vector<std::uint32_t>> dying_;
    std::uint32_t alive_count_, tick_ = 0, renewals_ = 0;
    base::InlineExecutor executor_;
};

/// Adds every phase of the measured ticks of a fresh world.
void measure(const parameters::Parameters& parameters, base::Seed seed, Times& times) {
    base::InlineExecutor executor;
    std::optional<World> world{std::in_place, parameters, seed};
    OpenIsland open{parameters, world->islands()[0]};
    for (std::uint32_t tick = 0; tick < warm_up_ticks; ++tick) {
        world->advance_tick(executor);
    }
    Laps laps{times};
    for (std::uint32_t tick = 0; tick < measured_ticks; ++tick) {
        world->advance_tick(executor);
    }
    laps.lap(WholeTick);
    const base::StateHash expected = world->islands()[0].hash();
    world.reset();

    Times warm_up;
    for (std::uint32_t tick = 0; tick < warm_up_ticks; ++tick) {
        open.advance_tick(warm_up);
    }
    for (std::uint32_t tick = 0; tick < measured_ticks; ++tick) {
        open.advance_tick(times);
    }
    if (open.hash() != expected) {
        throw std::runtime_error{"phase_bench: its ticks are not those of an island any more"};
    }
}

/// The same of as many worlds as make the measured time long enough.
Times measure(std::uint32_t organisms) {
    Times times;
    const std::uint64_t worlds = std::max(1u, 200'000 / organisms);
    for (std::uint64_t seed = 1; seed <= worlds; ++seed) {
        measure(bench_world(organisms), base::Seed{seed}, times);
    }
    return times;
}

/// Repetition k of each phase shows the k-th measurement of its population.
void show(benchmark::State& state, Phase phase, std::uint32_t organisms) {
    static std::map<std::uint32_t, std::vector<Times>> measurements;
    static std::map<std::pair<Phase, std::uint32_t>, std::size_t> shown;
    std::vector<Times>& known = measurements[organisms];
    const std::size_t k = shown[{phase, organisms}]++;
    for (auto _ : state) {
        if (k == known.size()) {
            known.push_back(measure(organisms));
        }
        state.SetIterationTime(known[k].s[phase]);
        state.SetItemsProcessed(static_cast<std::int64_t>(known[k].organism_ticks));
        state.counters["ns"] = 1e9 * known[k].s[phase] / static_cast<double>(known[k].organism_ticks);
    }
}

const bool registered = [] {
    for (const std::uint32_t organisms : {1'000u, 20'000u, 200'000u, 1'000'000u}) {
        for (std::size_t phase = 0; phase < phase_count; ++phase) {
            benchmark::RegisterBenchmark((std::string{phase_names[phase]} + "/" + std::to_string(organisms)).c_str(),
                                         show, static_cast<Phase>(phase), organisms)
                ->Iterations(1)
                ->UseManualTime()
                ->Unit(benchmark::kMillisecond);
        }
    }
    return true;
}();

} // namespace
} // namespace evod::bench
