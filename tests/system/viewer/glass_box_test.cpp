// The glass box against evod: the viewer shows what the server computed.
//
// Runs under Xvfb.
#include "client/viewer/panels/breeding/breeding_panel.h"
#include "client/viewer/panels/breeding/comparison.h"
#include "client/viewer/panels/breeding/family.h"
#include "client/viewer/panels/breeding/tournament.h"
#include "client/viewer/panels/breeding/wheel_layout.h"
#include "tests/system/viewer/support/panel_host.h"
#include "tests/system/viewer/support/pixels.h"
#include "tests/system/viewer/support/processes.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace evod::viewer {
namespace {

constexpr std::uint64_t parents_generation = 2;

/// Creates a world, lets it breed twice, and returns the complete record of the second breeding.
BreedingRecord breed(RealServer& server, const std::string& name,
                     std::vector<std::pair<std::string, evod::v1::ParameterValue>> parameters) {
    parameters.emplace_back("population_size", count(40));
    parameters.emplace_back("generation_s", real(4));
    server.make_world({.name = name, .seed = 11, .parameters = std::move(parameters)});
    server.run_generations(name, parents_generation + 1);
    BreedingRecord record{{.world = name, .run_id = "", .island = 0, .generation = parents_generation}};
    for (const Moment moment : {Moment{}, Moment{BreedingStage::Picking, 0}, Moment{BreedingStage::Breeding, 0}}) {
        while (const auto wanted = record.wanted(moment)) {
            evod::v1::Request request;
            *request.mutable_get_breeding() = *wanted;
            const auto response = server.connection->request(request, hang).value();
            EXPECT_TRUE(core::accepted(response)) << core::to_text(response.status());
            record.add(response.breeding());
            if (!record.known()) {
                return record;
            }
        }
    }
    return record;
}

/// Checks that the record is consistent, and that it agrees with theory.
void check(const BreedingRecord& record) {
    ASSERT_TRUE(record.known());
    const evod::v1::Breeding& breeding = record.breeding();
    ASSERT_EQ(breeding.contenders_size(), 40);
    ASSERT_EQ(static_cast<std::uint32_t>(breeding.picks_size()), breeding.pick_count());
    ASSERT_EQ(breeding.descendants_size(), 40);
    const auto comparison = compare(record);
    ASSERT_TRUE(comparison);
    EXPECT_EQ(copies_after(record, breeding.pick_count()), comparison->copies);
    double expected = 0;
    for (std::size_t rank = 0; rank < comparison->organisms.size(); ++rank) {
        EXPECT_TRUE(std::isfinite(comparison->deviations[rank])) << "impossible copies of rank " << rank;
        expected += comparison->expected.copies[rank];
    }
    EXPECT_NEAR(expected, breeding.pick_count(), 1e-9 * breeding.pick_count());
    for (std::uint32_t i = 0; i < breeding.pick_count(); ++i) {
        const evod::v1::Pick& pick = *record.pick(i);
        if (pick.has_turns()) {
            EXPECT_EQ(slot_at(breeding.contenders(), pick.turns()), record.contender(pick.organism())) << "pick " << i;
        }
        if (!pick.contestants().empty()) {
            const auto contestants = contestants_of(record, i);
            const auto winner = std::ranges::find(contestants, true, &Contestant::picked_now);
            ASSERT_NE(winner, contestants.end()) << "pick " << i;
            for (const Contestant& contestant : contestants) {
                EXPECT_TRUE(contestant.won || record.contender(contestant.organism)->rank() >=
                                                  record.contender(winner->organism)->rank());
            }
        }
    }
    unsigned changes = 0;
    for (const evod::v1::Descendant& descendant : breeding.descendants()) {
        const Family family = family_of(descendant);
        EXPECT_EQ(family.genes, std::vector<float>(descendant.genes().begin(), descendant.genes().end()))
            << "descendant " << descendant.id();
        for (const GeneChange& change : family.changes) {
            EXPECT_NE(change.delta(), 0);
            ++changes;
        }
    }
    EXPECT_GT(changes, 0u);
}

TEST(GlassBox, EverySelectionMatchesTheServer) {
    TemporaryFolder folder; // the server computes breedings from run files
    RealServer server{{"--seed", "7", "--data", folder.file("runs")}};
    for (const char* method : {"roulette", "stochastic_universal", "tournament", "random", "truncation"}) {
        SCOPED_TRACE(method);
        check(breed(server, method, {{"selection", choice(method)}}));
    }
}

TEST(GlassBox, EveryScalingMatchesTheServer) {
    TemporaryFolder folder; // the server computes breedings from run files
    RealServer server{{"--seed", "7", "--data", folder.file("runs")}};
    for (const char* scaling : {"none", "windowing", "linear_ranking", "exponential_ranking"}) {
        SCOPED_TRACE(scaling);
        check(breed(server, scaling, {{"fitness_scaling", choice(scaling)}}));
    }
}

TEST(GlassBox, EveryOperatorReproducesTheGenes) {
    TemporaryFolder folder; // the server computes breedings from run files
    RealServer server{{"--seed", "7", "--data", folder.file("runs")}};
    for (const char* rearranging : {"swap", "scramble", "inversion"}) {
        for (const char* crossover : {"single_point", "multi_point"}) {
            SCOPED_TRACE(std::string{rearranging} + " " + crossover);
            check(breed(server, std::string{rearranging} + "-" + crossover,
                        {{"rearranging", choice(rearranging)},
                         {"rearrange_chance", real(0.7)},
                         {"crossover", choice(crossover)},
                         {"crossover_chance", real(0.8)},
                         {"population_model", choice("generational")},
                         {"tournament_winners", count(2)},
                         {"selection", choice("tournament")},
                         {"elite_count", count(3)},
                         {"mutation_step", real(60)},
                         {"reset_chance", real(0.1)},
                         {"bit_flip_chance", real(0.02)}}));
        }
    }
}

/// The panel alone, with key presses.
class GlassBox {
  public:
    explicit GlassBox(const std::string& server)
        : world_{{.connection = {.server = core::parse_endpoint(server).value()}, .world = ""}} {}

    void press(sf::Keyboard::Key key) { host_.press(key); }
    /// Draws until at least this many pixels have the colour.
    bool sees(Colour colour, std::size_t least) {
        return wait_until([&] { return count(host_.draw(), colour) >= least; });
    }
    bool sees_none_of(Colour colour) {
        return wait_until([&] { return count(host_.draw(), colour) == 0; });
    }

  private:
    BreedingPanel panel_;
    ViewedWorld world_;
    IslandView island_view_;
    PanelHost host_{1000, 720, [this](Gui& gui) {
                        const auto now = std::chrono::steady_clock::now();
                        world_.update(now);
                        ImGui::SetNextWindowPos({10, 10});
                        ImGui::SetNextWindowSize({panel_.first_size().width, panel_.first_size().height});
                        ImGui::Begin("Glass box");
                        Panel::Context context{.world = world_, .gui = gui, .now = now, .island_view = island_view_};
                        panel_.build(context);
                        ImGui::End();
                    }};
};

TEST(GlassBox, KeysStepThroughABreedingAndBack) {
    TemporaryFolder folder;
    RealServer server{{"--seed", "7", "--speed", "max", "--data", folder.file("runs")}};
    server.run_generations("", 3);
    GlassBox window{server.address()};
    const Colour fittest = rank_colour(0, 50);
    EXPECT_TRUE(window.sees(fittest, 1000)) << "the highest bar";
    EXPECT_TRUE(window.sees_none_of(palette::first_parent));
    window.press(sf::Keyboard::PageDown);
    window.press(sf::Keyboard::PageDown);
    EXPECT_TRUE(window.sees(palette::first_parent, 5000)) << "the genes of the first organism";
    EXPECT_TRUE(window.sees_none_of(palette::second_parent)) << "the first organism is a survivor";
    window.press(sf::Keyboard::End);
    EXPECT_TRUE(window.sees_none_of(palette::first_parent));
    EXPECT_TRUE(window.sees(fittest, 1000));
    window.press(sf::Keyboard::Left);
    EXPECT_TRUE(window.sees(palette::second_parent, 500)) << "the genes of the last organism, a child";
    window.press(sf::Keyboard::Home);
    EXPECT_TRUE(window.sees_none_of(palette::second_parent));
}

} // namespace
} // namespace evod::viewer
