// The glass box against evod: what is worked out here of a breeding is what the server did.
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

namespace evod::viewer {
namespace {

constexpr std::uint64_t bred_from = 2; // generation

/// A world of its own that has bred twice; the record of the second time, whole.
BreedingRecord breed(RealServer& server, const std::string& name,
                     std::vector<std::pair<std::string, evod::v1::ParameterValue>> parameters) {
    parameters.emplace_back("population_size", count(40));
    parameters.emplace_back("generation_s", real(4));
    server.make_world({.name = name, .seed = 11, .parameters = std::move(parameters)});
    server.run_generations(name, bred_from + 1);
    BreedingRecord record{{.world = name, .run_id = "", .island = 0, .generation = bred_from}};
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

/// That the record agrees with itself and with theory.
void check(const BreedingRecord& record) {
    ASSERT_TRUE(record.known());
    const evod::v1::Breeding& breeding = record.breeding();
    ASSERT_EQ(breeding.contenders_size(), 40);
    ASSERT_EQ(static_cast<std::uint32_t>(breeding.picks_size()), breeding.pick_count());
    ASSERT_EQ(breeding.descendants_size(), 40);
    const auto comparison = compare(record);
    ASSERT_TRUE(comparison);
    EXPECT_EQ(copies_after(record, breeding.pick_count()), comparison->copies);
    for (std::size_t rank = 0; rank < comparison->organisms.size(); ++rank) {
        const double of_server = record.contender(comparison->organisms[rank])->expected_copies();
        EXPECT_NEAR(comparison->expected.copies[rank], of_server, 1e-9 * breeding.pick_count()) << "rank " << rank;
    }
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

TEST(GlassBox, WhatIsShownOfEverySelectionIsWhatTheServerDid) {
    TemporaryFolder folder; // what has happened is worked out from run files
    RealServer server{{"--seed", "7", "--data", folder.file("runs")}};
    for (const char* method : {"roulette", "stochastic_universal", "tournament", "random", "truncation"}) {
        SCOPED_TRACE(method);
        check(breed(server, method, {{"selection", choice(method)}}));
    }
}

TEST(GlassBox, EveryScalingOfTheWheelIsKnownHere) {
    TemporaryFolder folder; // what has happened is worked out from run files
    RealServer server{{"--seed", "7", "--data", folder.file("runs")}};
    for (const char* scaling : {"none", "windowing", "linear_ranking", "exponential_ranking"}) {
        SCOPED_TRACE(scaling);
        check(breed(server, scaling, {{"fitness_scaling", choice(scaling)}}));
    }
}

TEST(GlassBox, GenesAreFollowedThroughEveryOperator) {
    TemporaryFolder folder; // what has happened is worked out from run files
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

/// The panel alone, with a person at the keys.
class GlassBox {
  public:
    explicit GlassBox(const std::string& server)
        : world_{{.connection = {.server = core::parse_endpoint(server).value()}, .world = ""}} {}

    void press(sf::Keyboard::Key key) { host_.press(key); }
    /// Draws until so many pixels of the colour are seen.
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

TEST(GlassBox, KeysGoThroughABreedingAndBack) {
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
    EXPECT_TRUE(window.sees_none_of(palette::second_parent)) << "which is a survivor";
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
