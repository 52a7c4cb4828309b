// The glass box against evod: what is worked out here of a breeding is what the server did.
//
// Runs under Xvfb.
#include "client/viewer/panels/breeding/breeding_panel.h"
#include "client/viewer/panels/breeding/comparison.h"
#include "client/viewer/panels/breeding/family.h"
#include "client/viewer/panels/breeding/tournament.h"
#include "client/viewer/panels/breeding/wheel_layout.h"
#include "client/viewer/shell/window.h"
#include "tests/system/viewer/processes.h"

#include <GL/gl.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>

namespace evod::viewer {
namespace {

constexpr std::uint64_t bred_from = 2; // generation

void set(evod::v1::CreateWorld& world, const char* name, const evod::v1::ParameterValue& value) {
    auto& parameter = *world.add_parameters();
    parameter.set_name(name);
    *parameter.mutable_value() = value;
}
evod::v1::ParameterValue choice(const char* name) {
    evod::v1::ParameterValue value;
    value.set_choice(name);
    return value;
}
evod::v1::ParameterValue count(std::uint32_t number) {
    evod::v1::ParameterValue value;
    value.set_count(number);
    return value;
}
evod::v1::ParameterValue real(double number) {
    evod::v1::ParameterValue value;
    value.set_real(number);
    return value;
}

/// A world of its own that has bred twice; the record of the second time, whole.
BreedingRecord breed(RealServer& server, const std::string& name,
                     const std::vector<std::pair<const char*, evod::v1::ParameterValue>>& parameters) {
    evod::v1::Request create, speed, run;
    auto& world = *create.mutable_create_world();
    world.set_name(name);
    world.set_seed(11);
    set(world, "population_size", count(40));
    set(world, "generation_s", real(4));
    for (const auto& [parameter, value] : parameters) {
        set(world, parameter, value);
    }
    server.ask(create);
    speed.mutable_set_speed()->set_world(name);
    speed.mutable_set_speed()->mutable_speed()->set_max(true);
    server.ask(speed);
    run.mutable_run()->set_world(name);
    run.mutable_run()->set_generations(bred_from + 1);
    server.ask(run);
    evod::v1::Request state;
    state.mutable_get_statistics()->set_world(name);
    EXPECT_TRUE(comes_true([&] { return server.ask(state).state() == evod::v1::RUN_STATE_WAITING; }));
    BreedingRecord record{{.world = name, .run_id = "", .island = 0, .generation = bred_from}};
    for (const Moment moment : {Moment{}, Moment{BreedingStage::Picking, 0}, Moment{BreedingStage::Breeding, 0}}) {
        while (const auto wanted = record.wanted(moment)) {
            evod::v1::Request request;
            *request.mutable_get_breeding() = *wanted;
            const auto response = server.connection->request(request).value();
            EXPECT_TRUE(link::accepted(response)) << link::to_text(response.status());
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

/// The panel in a window of its own, with a person at the keys.
class PanelWindow {
  public:
    static constexpr unsigned width = 1000, height = 720;

    explicit PanelWindow(const std::string& server)
        : window_{sf::VideoMode{width, height}, "glass box", sf::Style::None, context_settings()}
        , watch_{wanted(server)} {}

    void press(sf::Keyboard::Key key) {
        sf::Event event{};
        event.key.code = key;
        for (const auto type : {sf::Event::KeyPressed, sf::Event::KeyReleased}) {
            event.type = type;
            gui_.handle(event);
            draw();
        }
    }
    /// Draws until so many pixels of the colour are seen.
    bool sees(Colour colour, unsigned least) {
        return comes_true([&] { return draw() && count(colour) >= least; });
    }
    bool sees_none_of(Colour colour) {
        return comes_true([&] { return draw() && count(colour) == 0; });
    }
    unsigned count(Colour colour) const {
        unsigned found = 0;
        for (std::size_t i = 0; i < pixels_.size(); i += 4) {
            found += pixels_[i] == colour.red && pixels_[i + 1] == colour.green && pixels_[i + 2] == colour.blue;
        }
        return found;
    }

  private:
    static Watch::Wanted wanted(const std::string& server) {
        Watch::Wanted wanted;
        wanted.connection.server = link::parse_endpoint(server).value();
        return wanted;
    }

    bool draw() {
        const auto now = std::chrono::steady_clock::now();
        watch_.update(now);
        gui_.begin(width, height, 0.02);
        glClearColor(1, 1, 1, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        ImGui::SetNextWindowPos({10, 10});
        const Panel::Size size = panel_.first_size();
        ImGui::SetNextWindowSize({size.width, size.height});
        ImGui::Begin("Glass box");
        Panel::Context context{.watch = watch_, .gui = gui_, .now = now, .sight = sight_};
        panel_.build(context);
        ImGui::End();
        gui_.draw();
        glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels_.data());
        return true;
    }

    sf::Window window_;
    Gui gui_;
    BreedingPanel panel_;
    Watch watch_;
    Sight sight_;
    std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(std::size_t{4} * width * height);
};

TEST(GlassBox, KeysGoThroughABreedingAndBack) {
    TemporaryFolder folder;
    RealServer server{{"--seed", "7", "--speed", "max", "--data", folder.file("runs")}};
    evod::v1::Request run;
    run.mutable_run()->set_generations(3);
    server.ask(run);
    ASSERT_TRUE(comes_true([&] { return server.state().state() == evod::v1::RUN_STATE_WAITING; }));
    PanelWindow window{server.address()};
    const Colour fittest = rank_colour(0, 50);
    EXPECT_TRUE(window.sees(fittest, 1000)) << "the highest bar";
    EXPECT_EQ(window.count(palette::first_parent), 0u);
    window.press(sf::Keyboard::PageDown);
    window.press(sf::Keyboard::PageDown);
    EXPECT_TRUE(window.sees(palette::first_parent, 5000)) << "the genes of the first organism";
    EXPECT_EQ(window.count(palette::second_parent), 0u) << "which is a survivor";
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
