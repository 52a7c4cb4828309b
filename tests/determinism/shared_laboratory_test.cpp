// A laboratory whose worlds are shared by several processes equals one that is alone: it gives the same results of
// commands, the same states, events, records, snapshots and answers to queries.
#include "evod/v1/commands.pb.h"
#include "server/base/inline_executor.h"
#include "server/protocol/queries.h"
#include "server/run_file/records.h"
#include "server/runtime/snapshot.h"
#include "server/simulation/laboratory.h"
#include "tests/determinism/scenarios.h"
#include "tests/support/shared_worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace evod::simulation {
namespace {

using base::Result;

const std::vector<std::string>& experiments() {
    static const std::vector<std::string> all{
        R"({"island_count": 6, "population_size": 12, "generation_s": 1, "food_count": 20, "poison_count": 10,
            "obstacle_count": 2, "crate_count": 2, "migration": "ring", "migration_epoch": 1, "migrant_count": 2})",
        R"({"island_count": 4, "population_size": 9, "generation_s": 1, "food_count": 8, "poison_count": 8,
            "controller": "network", "migration": "fully_connected", "migration_epoch": 2, "migrant_count": 1})",
        R"({"island_count": 5, "population_size": 8, "generation_s": 0.5, "food_count": 0, "health_loss_per_s": 90,
            "respawn": false, "migration": "random", "migration_epoch": 1})",
        R"({"island_count": 4, "population_size": 7, "generation_s": 0.25, "fitness": "external"})",
        R"({"island_count": 4, "population_size": 20, "fitness": "gene_sum", "migration": "ring",
            "migration_epoch": 1})",
        R"({"island_count": 2, "population_size": 8, "generation_s": 1})", // fewer islands than processes: not shared
    };
    return all;
}

/// Draws what happens to a laboratory.
class Draws {
  public:
    explicit Draws(std::uint32_t seed) : engine_{seed} {}
    std::uint32_t below(std::uint32_t limit) {
        return static_cast<std::uint32_t>(std::uniform_int_distribution<std::uint64_t>{0, limit - 1}(engine_));
    }
    double number(double min, double max) { return std::uniform_real_distribution{min, max}(engine_); }
    template <class Values>
    const auto& one_of(const Values& values) {
        return values[below(static_cast<std::uint32_t>(values.size()))];
    }

    Command command(const Laboratory& laboratory) {
        static const std::vector<std::string> names{"a", "b", "c", "d"};
        const std::string world = one_of(names);
        const RunId run_id{++runs_, 7};
        const auto found = laboratory.find(world);
        if (!found || below(30) == 0) {
            return CreateWorld{.name = world,
                               .parameters = scenarios::parameters_of(one_of(experiments())),
                               .seed = base::Seed{below(1000)},
                               .run_id = run_id};
        }
        const World& there = (*found)->world;
        if (there.awaits_fitness() && below(4) > 0) {
            return fitness(world, there);
        }
        switch (below(12)) {
        case 0:
            return ResetWorld{.world = world, .seed = base::Seed{below(1000)}, .run_id = run_id};
        case 1:
        case 2:
            return ForkWorld{.world = world, .name = one_of(names), .at_generation = {}, .run_id = run_id};
        case 3:
            return below(2) == 0 ? Command{DeleteWorld{world}} : CancelChange{.world = world, .id = 1 + below(4)};
        case 4:
        case 5:
            return change(world, there);
        case 6:
        case 7:
            return removal(world, there);
        default:
            return placement(world, there);
        }
    }

  private:
    Command fitness(const std::string& world, const World& there) {
        SetFitness command{.world = world, .generation = there.moment().generation, .fitness = {}};
        command.island = below(there.island_count());
        for (std::uint32_t i = 0; i < there.organism_count(command.island) + below(9) / 8; ++i) {
            command.fitness.push_back(number(-5, 5));
        }
        return command;
    }
    Command change(const std::string& world, const World& there) {
        SetParameters command{.world = world,
                              .assignments = {},
                              .expected_revision = {},
                              .by = base::client_actor("user", "evoctl", "127.0.0.1:5000")};
        command.assignments.push_back(below(2) == 0
                                          ? parameters::Assignment{"health_loss_per_s", number(0, 120)}
                                          : parameters::Assignment{"population_size", std::uint32_t{4 + below(12)}});
        if (below(3) == 0) {
            command.assignments.push_back({"mutation_chance", number(0, 1)});
        }
        if (below(3) == 0) {
            command.at = {.generation = there.moment().generation + 1, .tick = {}};
        } else if (below(2) == 0) {
            command.at = {.generation = {}, .tick = there.moment().tick + 1 + below(30)};
        }
        return command;
    }
    Command removal(const std::string& world, const World& there) {
        RemoveEntities command{.world = world, .island = below(there.island_count() + 1)};
        const std::uint32_t count = below(12);
        for (std::uint32_t id = 0; id < count; ++id) { // sometimes all organisms of an island
            command.organisms.push_back(id);
        }
        if (below(2) == 0) {
            command.food = {below(8)};
        }
        return command;
    }
    Command placement(const std::string& world, const World& there) {
        PlaceEntities command{.world = world, .island = below(there.island_count() + 1)};
        const parameters::Parameters& p = there.parameters().active;
        for (std::uint32_t i = 1 + below(3); i > 0; --i) {
            const double x = number(0, p.island_width_px), y = number(0, p.island_height_px);
            if (below(2) == 0) {
                command.items.push_back({below(2) == 0 ? ItemKind::Food : ItemKind::Poison, x, y});
                continue;
            }
            const evolution::ConstGenes genes = evolution::column(there.island(0).born().genes, 0);
            command.organisms.push_back({x, y, {genes.begin(), genes.end()}});
        }
        return command;
    }

    std::mt19937_64 engine_;
    std::uint64_t runs_ = 0;
};

std::string text_of(const Result<Applied>& applied) {
    if (!applied) {
        return base::to_text(applied.error());
    }
    std::string text = applied->world + " " + std::to_string(applied->tick);
    for (const auto& ids : {applied->placed, applied->removed}) {
        for (const auto& list :
             ids ? std::vector{ids->food, ids->poison, ids->organisms} : std::vector<std::vector<std::uint32_t>>{}) {
            for (const std::uint32_t id : list) {
                text += " " + std::to_string(id);
            }
            text += ";";
        }
    }
    return text;
}

std::string answer_to(const v1::Request& request, const Laboratory& laboratory) {
    v1::Response response;
    protocol::add_rows(protocol::answer_query(request, laboratory, false, response), response);
    return response.SerializeAsString();
}

/// Requests that read everything of a world that can be read.
std::vector<v1::Request> queries(const std::string& world, std::uint32_t islands) {
    std::vector<v1::Request> all;
    const auto add = [&](auto&& fill) { fill(all.emplace_back()); };
    add([&](v1::Request& request) { request.mutable_get_statistics()->set_world(world); });
    add([&](v1::Request& request) { request.mutable_get_history()->set_world(world); });
    add([&](v1::Request& request) { request.mutable_get_parameters()->set_world(world); });
    add([&](v1::Request& request) { request.mutable_list_worlds(); });
    for (std::uint32_t island = 0; island <= islands; ++island) {
        add([&](v1::Request& request) {
            request.mutable_get_motion()->set_world(world);
            request.mutable_get_motion()->set_island(island);
        });
        add([&](v1::Request& request) {
            request.mutable_get_population()->set_world(world);
            request.mutable_get_population()->set_island(island);
            request.mutable_get_population()->set_with_life(true);
        });
        for (const std::uint32_t organism : {0U, 5U, 1'000U}) {
            add([&](v1::Request& request) {
                request.mutable_get_organism()->set_world(world);
                request.mutable_get_organism()->set_island(island);
                request.mutable_get_organism()->set_organism(organism);
            });
        }
    }
    return all;
}

/// What a viewer sees of an island, by id: the order in memory is not part of it.
std::vector<float> numbers_of(const runtime::IslandSnapshot& island) {
    std::vector<float> numbers{
        static_cast<float>(island.organisms.alive_count), static_cast<float>(island.food.present_count),
        static_cast<float>(island.poison.present_count), static_cast<float>(island.live.food_eaten)};
    for (const std::uint32_t place : island.organisms.place_of) {
        if (place == Island::no_body) {
            numbers.push_back(-1);
            continue;
        }
        numbers.insert(numbers.end(),
                       {static_cast<float>(island.organisms.x[place]), static_cast<float>(island.organisms.y[place]),
                        island.organisms.radius_px[place], island.organisms.health[place]});
        if (!island.organisms.heading.empty()) {
            numbers.push_back(island.organisms.heading[place]);
        }
    }
    for (const auto& boxes : {island.boxes.x, island.boxes.y}) {
        numbers.insert(numbers.end(), boxes.begin(), boxes.end());
    }
    return numbers;
}

void expect_equal_snapshots(const Entry& alone, const Entry& shared) {
    std::vector<std::uint32_t> islands(alone.world.island_count());
    std::iota(islands.begin(), islands.end(), 0U);
    runtime::SnapshotPool pool;
    const auto one = pool.take(alone, islands, false), other = pool.take(shared, islands, false);
    EXPECT_EQ(one->hash, other->hash);
    for (const std::uint32_t island : islands) {
        EXPECT_EQ(numbers_of(one->islands[island]), numbers_of(other->islands[island]));
        EXPECT_EQ(one->islands[island].food.all, other->islands[island].food.all);
        EXPECT_EQ(one->islands[island].poison.all, other->islands[island].poison.all);
    }
}

void expect_equal_records(const World& alone, const World& shared, base::Executor& executor) {
    const auto one = run_file::beginning_of(alone), other = run_file::beginning_of(shared);
    ASSERT_EQ(one.founders, other.founders);
    ASSERT_EQ(one.born.size(), other.born.size());
    for (std::size_t island = 0; island < one.born.size(); ++island) {
        EXPECT_TRUE((one.born[island].genes == other.born[island].genes).all());
        EXPECT_EQ(one.born[island].parents, other.born[island].parents);
        EXPECT_EQ(one.born[island].account, other.born[island].account);
    }
    base::InlineExecutor here;
    const WorldState state = alone.state(here), gathered = shared.state(executor);
    EXPECT_EQ(state.islands, gathered.islands);
    EXPECT_EQ(state.ratings, gathered.ratings);
    EXPECT_EQ(state.ended.size(), gathered.ended.size());
    if (alone.generation_over()) {
        EXPECT_EQ(run_file::end_of(alone).outcomes, run_file::end_of(shared).outcomes);
    }
}

void expect_equal(const Laboratory& alone, const Laboratory& shared, bool deeply, base::Executor& executor) {
    ASSERT_EQ(alone.entries().size(), shared.entries().size());
    for (std::size_t i = 0; i < alone.entries().size(); ++i) {
        const Entry &one = *alone.entries()[i], &other = *shared.entries()[i];
        ASSERT_EQ(one.name, other.name);
        ASSERT_EQ(one.world.moment(), other.world.moment());
        ASSERT_EQ(one.world.hash(), other.world.hash());
        ASSERT_EQ(one.world.alive_count(), other.world.alive_count());
        ASSERT_EQ(one.world.outcome(), other.world.outcome());
        ASSERT_EQ(one.world.awaits_fitness(), other.world.awaits_fitness());
        ASSERT_EQ(one.world.is_as_begun(), other.world.is_as_begun());
        ASSERT_EQ(one.world.planned(), other.world.planned());
        if (!deeply) {
            continue;
        }
        for (const v1::Request& request : queries(one.name, one.world.island_count())) {
            ASSERT_EQ(answer_to(request, alone), answer_to(request, shared)) << request.ShortDebugString();
        }
        expect_equal_snapshots(one, other);
        expect_equal_records(one.world, other.world, executor);
    }
}

void expect_equal_events(std::vector<Event> alone, std::vector<Event> shared) {
    // Events of one tick may come in another order.
    const auto key = [](const Event& event) { return std::tuple{event.tick, event.world, event.kind.index()}; };
    const auto by_key = [&](const Event& a, const Event& b) { return key(a) < key(b); };
    std::ranges::stable_sort(alone, by_key);
    std::ranges::stable_sort(shared, by_key);
    ASSERT_EQ(alone.size(), shared.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
        ASSERT_EQ(key(alone[i]), key(shared[i]));
        if (const auto* extinction = std::get_if<Extinction>(&alone[i].kind)) {
            ASSERT_EQ(extinction->island, std::get<Extinction>(shared[i].kind).island);
        }
    }
}

/// Advances all worlds that can advance by so many ticks, at most `slice` at a time.
void advance(Laboratory& laboratory, std::uint64_t ticks, std::uint64_t slice, base::Executor& executor) {
    for (const auto& entry : laboratory.entries()) {
        const World& world = entry->world;
        const std::uint64_t end = world.moment().tick + ticks;
        while (world.moment().tick < end && world.outcome() == evolution::Outcome::Running && !world.awaits_fitness()) {
            laboratory.advance(*entry, std::min(slice, end - world.moment().tick), executor);
        }
    }
}

/// Forks a world from the first moment of its generation, as a server does.
Result<Applied> fork_at_opening(Laboratory& laboratory, const ForkWorld& command, base::Executor& executor) {
    const auto origin = laboratory.find(command.world);
    if (!origin) {
        return origin.error();
    }
    return laboratory.adopt(command, (*origin)->world.at_its_opening(executor));
}

class SharedLaboratory : public testing::TestWithParam<std::uint32_t> {};

TEST_P(SharedLaboratory, EqualsOneThatIsAlone) {
    support::share_worlds(3, 1, [&](IslandsMaker& maker, base::Executor& executor) {
        base::InlineExecutor here;
        Draws draws{GetParam()};
        Laboratory alone, shared;
        shared.share(maker, executor);
        for (int step = 0; step < 150; ++step) {
            const Command command = draws.command(alone);
            const auto* fork = std::get_if<ForkWorld>(&command);
            if (fork != nullptr && draws.below(2) == 0) {
                ASSERT_EQ(text_of(fork_at_opening(alone, *fork, here)),
                          text_of(fork_at_opening(shared, *fork, executor)));
            } else {
                ASSERT_EQ(text_of(alone.apply(command)), text_of(shared.apply(command)));
            }
            ASSERT_NO_FATAL_FAILURE(expect_equal(alone, shared, false, executor));
            const std::uint32_t ticks = draws.below(2) == 0 ? 0 : draws.below(20);
            advance(alone, ticks, 1, here);
            advance(shared, ticks, 1 + draws.below(20), executor);
            ASSERT_NO_FATAL_FAILURE(expect_equal_events(alone.take_events(), shared.take_events()));
            ASSERT_NO_FATAL_FAILURE(expect_equal(alone, shared, draws.below(4) == 0, executor));
        }
    });
}

INSTANTIATE_TEST_SUITE_P(Seeds, SharedLaboratory, testing::Range(1U, 6U));

TEST(SharedLaboratories, ShareWorldsThatBeganBefore) {
    base::InlineExecutor here;
    for (const std::string& experiment : experiments()) {
        for (const std::uint32_t ticks : {0U, 14U, 15U, 61U}) {
            Laboratory alone;
            ASSERT_TRUE(alone.apply(CreateWorld{
                .name = "a", .parameters = scenarios::parameters_of(experiment), .seed = base::Seed{5}, .run_id = {}}));
            (void)alone.apply(SetParameters{.world = "a",
                                            .assignments = {{"health_loss_per_s", 3.0}},
                                            .expected_revision = {},
                                            .at = parameters::PlannedMoment{.generation = {}, .tick = 70}});
            advance(alone, ticks, 1, here);
            support::share_worlds(2, 1, [&](IslandsMaker& maker, base::Executor& executor) {
                Laboratory reference, shared;
                for (Laboratory* laboratory : {&reference, &shared}) {
                    const Entry& entry = *alone.entries().front();
                    laboratory->adopt(std::make_unique<Entry>(Entry{entry.name, {}, {}, entry.world.copy(here)}));
                }
                shared.share(maker, executor);
                ASSERT_TRUE(shared.entries().front()->world.is_shared());
                for (int step = 0; step < 6; ++step) {
                    ASSERT_NO_FATAL_FAILURE(expect_equal(reference, shared, true, executor)) << experiment;
                    advance(reference, 17, 1, here);
                    advance(shared, 17, 1, executor);
                }
            });
        }
    }
}

} // namespace
} // namespace evod::simulation
