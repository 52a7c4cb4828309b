// Extreme worlds: with every parameter at the edges of what is permitted, alone and together, no assertion fails and
// every number is finite. Each world is simulated, changed by commands, queried, restored from its state, and bred.
// A failure prints the seed; EXTREMES_SEED=SEED EXTREMES=1 repeats it.
#include "server/base/inline_executor.h"
#include "server/evolution/breeding_record.h"
#include "server/parameters/schedule.h"
#include "server/simulation/entities.h"
#include "server/simulation/rating.h"
#include "server/simulation/state_bytes.h"
#include "server/simulation/world.h"
#include "tests/extremes/extreme_parameters.h"
#include "tests/support/everyday.h"
#include "tests/support/shared_worlds.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace evod::extremes {
namespace {

using simulation::Island;
using simulation::World;

std::string present_world; // its seed and parameters

/// A failed assertion of the program under test ends it; this prints the world that caused it.
void on_abort(int) {
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, present_world.data(), present_world.size());
}

std::string text_of(const parameters::Parameters& set) {
    std::string text;
    for (const auto* changed : parameters::parameters_that_differ(set, {})) {
        text += " --set " + std::string{changed->name} + "=" + parameters::to_text(changed->get(set));
    }
    return text;
}

template <class Number>
void expect_finite(const std::string& name, Number number) {
    if constexpr (std::is_floating_point_v<Number>) {
        EXPECT_TRUE(std::isfinite(number)) << name << " is " << number;
    }
}

/// One world and the commands that it gets.
class Extreme {
  public:
    Extreme(World& world, Draws& draws, base::Executor& executor) : world_{world}, draws_{draws}, executor_{executor} {}

    void live() {
        for (int act = 0; act < 24 && !testing::Test::HasFailure(); ++act) {
            this->act();
            look();
        }
    }

  private:
    void act() {
        switch (draws_.below(10)) {
        case 0:
            return request();
        case 1:
            return place();
        case 2:
            return remove();
        default:
            break;
        }
        if (world_.awaits_fitness()) {
            return rate();
        }
        if (world_.outcome() == evolution::Outcome::Running) {
            world_.advance(world_.moment().tick + draws_.count(1, 5), executor_);
        }
    }

    void request() {
        const parameters::Assignment assignment = extreme_assignment(world_.parameters().requested.values, draws_);
        if (const auto requested = parameters::request_of(world_.parameters(), {&assignment, 1})) {
            note(" set " + assignment.name + "=" + parameters::to_text(assignment.value));
            world_.request_parameters(*requested);
        }
    }

    std::uint32_t any_island() { return draws_.count(0, world_.island_count() - 1); }

    void place() {
        simulation::PlaceEntities command{.world = {}, .island = any_island()};
        const parameters::IslandPlan plan = parameters::island_plan(world_.parameters().active);
        const auto somewhere = [&](double size) {
            constexpr double shares[] = {0, 0.5, 1, 0.999999, 1e-9};
            return size * (draws_.chance(0.4) ? draws_.one_of(shares) : draws_.number(0, 1));
        };
        command.items.push_back({draws_.chance(0.5) ? simulation::ItemKind::Food : simulation::ItemKind::Poison,
                                 somewhere(plan.width_px), somewhere(plan.height_px)});
        const evolution::GeneBounds bounds = evolution::gene_bounds(world_.parameters().active);
        const Eigen::ArrayXf& edge = draws_.chance(0.5) ? bounds.min : bounds.max;
        if (draws_.chance(0.5)) {
            command.organisms.push_back(
                {somewhere(plan.width_px), somewhere(plan.height_px), {edge.begin(), edge.end()}});
        }
        if (check(world_, command)) {
            note(" place");
            world_.place(command);
        }
    }

    void remove() {
        simulation::RemoveEntities command{.world = {}, .island = any_island()};
        const Island& island = world_.island(command.island);
        for (std::uint32_t id = 0; id < island.born().genes.cols(); ++id) {
            if (island.body_of(id) && (draws_.chance(0.7) || world_.moment().tick % 2 == 0)) {
                command.organisms.push_back(id);
            }
        }
        for (std::uint32_t id = 0; id < island.food().size(); ++id) {
            if (island.food().present(id) && draws_.chance(0.5)) {
                command.food.push_back(id);
            }
        }
        if (check(world_, command)) {
            note(" remove");
            world_.remove(command);
        }
    }

    void rate() {
        constexpr double max = simulation::given_fitness_max;
        constexpr double values[] = {0, -0.0, max, -max, 5e-324, -5e-324, 1, 1e-300, 1 + 1e-15};
        const bool all_equal = draws_.chance(0.2);
        const double value = draws_.one_of(values);
        for (std::uint32_t island = 0; island < world_.island_count(); ++island) {
            simulation::SetFitness command{
                .world = {}, .generation = world_.moment().generation, .island = island, .fitness = {}};
            command.fitness.resize(world_.organism_count(island));
            for (double& fitness : command.fitness) {
                fitness = all_equal ? value : draws_.one_of(values);
            }
            if (check(world_, command)) {
                world_.set_fitness(command);
            }
        }
        note(" rate");
    }

    void look() {
        for (std::uint32_t i = 0; i < world_.island_count(); ++i) {
            look_at(world_.island(i));
        }
        for (const simulation::LiveStatistics& live : world_.islands().live_statistics()) {
            expect_finite("health_mean", live.health_mean);
        }
        if (!world_.history().empty()) {
            for (const simulation::GenerationStatistics& row : world_.history().back()) {
                look_at(row);
            }
        }
        expect_finite("simulated_s", world_.moment().simulated_s);
        restore();
    }

    void look_at(const Island& island) {
        const auto organisms = static_cast<std::uint32_t>(island.born().genes.cols());
        for (const simulation::Intention& intention : world_.intentions(island, {0, organisms})) {
            expect_finite("force_x", intention.force_x);
            expect_finite("force_y", intention.force_y);
        }
        for (std::uint32_t id = 0; id < organisms; ++id) {
            if (const auto body = island.body_of(id)) {
                expect_finite("velocity_x", island.bodies().velocity_x[*body]);
                expect_finite("velocity_y", island.bodies().velocity_y[*body]);
                expect_finite("radius", island.bodies().radius[*body]);
                expect_finite("inverse mass", island.bodies().inverse_mass[*body]);
                expect_finite("health", island.living().health[*body]);
                EXPECT_EQ(std::clamp(island.bodies().x[*body], 0, island.area().width), island.bodies().x[*body]);
                EXPECT_EQ(std::clamp(island.bodies().y[*body], 0, island.area().height), island.bodies().y[*body]);
            }
            if (const auto activations = world_.activations(island, id)) {
                for (const auto& layer : {activations->inputs, activations->hidden, activations->outputs}) {
                    for (const float neuron : layer) {
                        expect_finite("neuron", neuron);
                    }
                }
            }
            for (const float gene : evolution::column(island.born().genes, id)) {
                expect_finite("gene", gene);
            }
        }
        const physics::MotionReport motion = island.motion_report(world_.parameters().active);
        for (const double number :
             {motion.kinetic_energy, motion.momentum_x, motion.momentum_y, motion.deepest_overlap_px,
              motion.deepest_overlap_share, motion.fastest_px_s, motion.fastest_step, motion.strip_px}) {
            expect_finite("motion report", number);
        }
        if (world_.generation_over()) {
            look_at_breeding(island);
        }
    }

    void look_at(const simulation::GenerationStatistics& row) {
        simulation::for_each_number(
            row, [](std::string_view name, auto number) { expect_finite(std::string{name}, number); });
        for (const simulation::GeneStatistics& gene : row.genes) {
            for (const double number : {gene.mean, gene.deviation, gene.min, gene.max}) {
                expect_finite("statistics of a gene", number);
            }
        }
        for (const auto& gene : row.account.value_or(evolution::SelectionAccount{})) {
            for (const double number : {gene.selection, gene.transmission, gene.migration, gene.change}) {
                expect_finite("account of a gene", number);
            }
        }
    }

    /// As the query for the breeding record does.
    void look_at_breeding(const Island& island) {
        const std::vector<double> fitness = world_.outcomes()[island.index()].fitness;
        const parameters::Parameters next = parameters::taking_effect(
            world_.parameters().active, world_.parameters().requested, base::Effect::NextGeneration);
        const evolution::BreedingRecord record = evolution::record_breeding(
            fitness, island.born().genes, next, next.population_size,
            {world_.seed(), island.index(), world_.moment().generation + 1}, {.count_max = 50}, executor_);
        for (const auto& contender : record.contenders) {
            for (const double number :
                 {contender.fitness, contender.weight, contender.slot_begin, contender.slot_end, contender.law.expected,
                  contender.law.standard_error, contender.law.unpicked_chance}) {
                expect_finite("contender", number);
            }
        }
        for (const auto& pick : record.picks) {
            EXPECT_LT(pick.turns.value_or(0), 1);
        }
    }

    /// Restores a world from the state, which is packed and unpacked, at the beginning of the generation.
    void restore() {
        const simulation::WorldState given = world_.state(executor_);
        std::string bytes;
        write_state(given, [&](std::string_view piece) { bytes += piece; });
        World copy{world_.seed(), world_.opening(), world_.bred(), {}, executor_};
        simulation::WorldState state = given;
        const auto read = read_state(bytes, copy.shapes(), state);
        ASSERT_TRUE(read) << to_text(read.error());
        EXPECT_EQ(state.islands, given.islands);
        const auto restored = copy.restore(state, executor_);
        ASSERT_TRUE(restored) << to_text(restored.error());
        EXPECT_EQ(copy.hash(), world_.hash());
    }

    void note(const std::string& what) {
        present_world += "tick " + std::to_string(world_.moment().tick) + ':' + what + '\n';
    }

    World& world_;
    Draws& draws_;
    base::Executor& executor_;
};

TEST(Extremes, FailNoAssertionAndGiveFiniteNumbers) {
    (void)std::signal(SIGABRT, on_abort);
    const std::uint64_t first = everyday_size("EXTREMES_SEED", 1), count = everyday_size("EXTREMES", 300);
    for (std::uint64_t seed = first; seed < first + count && !HasFailure(); ++seed) {
        Draws draws{seed};
        const parameters::Parameters set = extreme_parameters(draws);
        present_world = "seed " + std::to_string(seed) + text_of(set) + '\n';
        if (draws.chance(0.2)) {
            support::share_worlds(2, 1, [&](simulation::IslandsMaker& maker, base::Executor& executor) {
                World world{set, base::Seed{seed}, {}, {}, &maker};
                Extreme{world, draws, executor}.live();
            });
        } else {
            base::InlineExecutor executor;
            World world{set, base::Seed{seed}};
            Extreme{world, draws, executor}.live();
        }
        EXPECT_FALSE(HasFailure()) << present_world;
    }
}

} // namespace
} // namespace evod::extremes
