// The family tree against evod: the tree is that of the exported lineage, and a click shows a birth in a replay.
//
// Runs under Xvfb.
#include "client/viewer/island/legend.h"
#include "client/viewer/panels/family_tree/family_tree_panel.h"
#include "tests/system/viewer/support/panel_host.h"
#include "tests/system/viewer/support/processes.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <span>

namespace evod::viewer {
namespace {

/// A panel that shows the tree of a world, in a window of its own.
class TreeWindow {
  public:
    TreeWindow(const RealServer& server, const std::string& world)
        : world_{{.connection = {.server = core::parse_endpoint(server.address()).value(), .client_name = "a test"},
                  .world = world}} {
        camera_.set_viewport({0, 0, 500, 500});
        camera_.set_island(500, 500);
    }

    /// Draws until the condition holds.
    template <class Condition>
    bool draws_until(Condition condition) {
        return wait_until([&] {
            host_.draw();
            return condition();
        });
    }
    std::optional<Point> find(const std::string& widget) {
        host_.draw();
        const auto found = positions_->find(widget);
        return found.empty() ? std::nullopt : std::optional{found.front()->centre()};
    }
    void click(const std::string& widget) {
        const auto point = find(widget);
        ASSERT_TRUE(point) << widget;
        host_.click(static_cast<int>(point->x), static_cast<int>(point->y));
        host_.draw();
    }
    void turn_wheel(const std::string& widget, float notches) {
        const auto point = find(widget);
        ASSERT_TRUE(point) << widget;
        host_.move(static_cast<int>(point->x), static_cast<int>(point->y));
        host_.turn_wheel(notches);
        host_.draw();
    }

    ViewedWorld& world() { return world_; }
    const Lineage& lineage() const { return island_view_.lineage(); }
    IslandView& island_view() { return island_view_; }

  private:
    FamilyTreePanel panel_;
    ViewedWorld world_;
    IslandView island_view_;
    Camera camera_;
    WidgetPositions* positions_ = nullptr;
    PanelHost host_{420, 700, [this](Gui& gui) {
                        const auto now = std::chrono::steady_clock::now();
                        positions_ = &gui.widget_positions();
                        world_.update(now);
                        island_view_.update(world_, camera_, now);
                        ImGui::SetNextWindowPos({10, 10});
                        ImGui::SetNextWindowSize({400, 680});
                        ImGui::Begin("Family tree");
                        Panel::Context context{.world = world_, .gui = gui, .now = now, .island_view = island_view_};
                        panel_.build(context);
                        ImGui::End();
                    }};
};

struct FamilyTreeTest : testing::Test {
    void run(std::uint64_t generations, std::uint32_t island_count = 1) {
        server.make_world({.name = "w",
                           .seed = 11,
                           .parameters = {{"generation_s", real(2)},
                                          {"population_size", count(20)},
                                          {"island_count", count(island_count)},
                                          {"migration", choice("ring")},
                                          {"migration_epoch", count(2)}}});
        server.run_generations("w", generations);
    }

    TemporaryFolder folder;
    RealServer server{{"--seed", "7", "--data", folder.file("runs")}};
};

TEST_F(FamilyTreeTest, ShowsGenerationsBeforeTheViewerConnected) {
    run(30);
    TreeWindow window{server, "w"};
    ASSERT_TRUE(window.draws_until([&] { return window.find("tree of generation 30").has_value(); }));
    EXPECT_EQ(window.lineage().first(), 1u);
    for (std::uint64_t generation = 2; generation <= 30; ++generation) {
        for (const Lineage::Organism& organism : window.lineage().at(generation).organisms) {
            EXPECT_LT(std::max(organism.parents[0], organism.parents[1]), 20u);
        }
    }
    EXPECT_TRUE(window.find("organism 19")) << "an organism of the newest generation";
    ASSERT_TRUE(window.find("common ancestor"));
    server.run_generations("w", 2);
    EXPECT_TRUE(window.draws_until([&] { return window.find("tree of generation 32").has_value(); }));
}

TEST_F(FamilyTreeTest, AClickShowsTheBirthInAReplay) {
    run(30);
    TreeWindow window{server, "w"};
    ASSERT_TRUE(window.draws_until([&] { return window.find("common ancestor").has_value(); }));
    // The lines of first parents, followed back from the newest generation, meet in the common ancestor.
    std::uint64_t generation = 30;
    std::set<std::uint32_t> line;
    for (std::uint32_t organism = 0; organism < 20; ++organism) {
        line.insert(organism);
    }
    for (; line.size() > 1; --generation) {
        std::set<std::uint32_t> parents;
        for (const std::uint32_t organism : line) {
            parents.insert(window.lineage().at(generation).organisms[organism].parents[0]);
        }
        line = std::move(parents);
    }
    window.click("common ancestor");
    ASSERT_TRUE(window.draws_until([&] { return window.world().feed.selected() == *line.begin(); }));
    EXPECT_TRUE(window.world().replay.is_own());
    EXPECT_EQ(window.world().feed.snapshot()->about.generation(), generation);
    ASSERT_TRUE(window.draws_until([&] {
        const OrganismHistory* history = window.island_view().organism_history();
        return history != nullptr && history->info();
    }));
    EXPECT_EQ(window.island_view().organism_history()->info()->id(), *line.begin());
    EXPECT_TRUE(window.find("tree of generation 30")) << "the tree stays";
    window.click("organism 7");
    ASSERT_TRUE(window.draws_until([&] { return window.world().feed.selected() == 7u; })) << "a seek in the replay";
    EXPECT_EQ(window.world().feed.snapshot()->about.generation(), 30u);
}

TEST_F(FamilyTreeTest, AParentOnAnotherIslandIsShownThere) {
    run(20, 2);
    TreeWindow window{server, "w"};
    ASSERT_TRUE(window.draws_until([&] { return window.find("tree of generation 20").has_value(); }));
    EXPECT_EQ(window.lineage().at(20).begins.size(), 2u);
    bool migrated = false;
    for (std::uint64_t generation = 2; generation <= 20; ++generation) {
        const auto [begin, count] = window.lineage().island_range(generation, 0);
        for (std::uint32_t i = begin; i < begin + count; ++i) {
            const std::uint32_t parent = window.lineage().at(generation).organisms[i].parents[0];
            migrated = migrated || window.lineage().place_of(generation - 1, parent).island == 1;
        }
    }
    EXPECT_TRUE(migrated);
}

TEST_F(FamilyTreeTest, AnotherIslandHasItsOwnLineages) {
    run(40, 2);
    TreeWindow window{server, "w"};
    std::string script = "timeout 20\nwait snapshot\nkey F11\n";
    std::set<std::uint64_t> bases;
    for (const std::uint32_t island : {0u, 1u}) {
        window.world().feed.choose_island(island);
        ASSERT_TRUE(window.draws_until([&] {
            return window.island_view().lineage_is_current() && window.lineage().contains(40) &&
                   window.world().feed.snapshot() != nullptr;
        }));
        const std::uint64_t base = window.island_view().lineage_base_of(40);
        bases.insert(base);
        script += "wait widget \"lineages since generation " + std::to_string(base) +
                  "\"\nwait connected\nkey Tab\nwait connected\n";
    }
    ASSERT_EQ(bases.size(), 2u);
    const std::string path = folder.file("script");
    std::ofstream{path} << script << "quit\n";
    const Ran ran = run_evoview(server.address() + " --world w --script " + path);
    EXPECT_EQ(ran.status, 0) << ran.output;
}

TEST_F(FamilyTreeTest, LineagesKeepTheirColoursOnOtherIslands) {
    run(1, 2);
    TreeWindow window{server, "w"};
    window.island_view().options.colour_by = ColourBy::Lineage;
    const auto colours = [&] {
        std::vector<Colour> all;
        for (const Families::Family& family : window.island_view().families().shown()) {
            all.push_back(window.island_view().family_colours().of_founder(family.founder));
        }
        return all;
    };
    const auto are_new = [&] { // the colours of lineages that appear together
        const std::vector<Colour> all = colours();
        return std::ranges::equal(all, std::span{palette::lineages}.first(all.size()));
    };
    for (std::uint64_t generation = 2; generation < 30 && are_new(); ++generation) {
        server.run_generations("w", 1);
        ASSERT_TRUE(window.draws_until([&] {
            const Population* population = window.island_view().population();
            return population != nullptr && population->generation() == generation && !colours().empty();
        }));
    }
    ASSERT_FALSE(are_new());
    const std::vector<Colour> before = colours();
    window.world().feed.show_all_islands(true);
    ASSERT_TRUE(window.draws_until([&] { return colours().empty(); }));
    ASSERT_TRUE(window.draws_until([&] { return !colours().empty(); }));
    EXPECT_EQ(colours(), before);
}

TEST_F(FamilyTreeTest, TheWheelZoomsAndFitShowsTheTreeAgain) {
    run(30);
    TreeWindow window{server, "w"};
    ASSERT_TRUE(window.draws_until([&] { return window.find("common ancestor").has_value(); }));
    const auto before = window.find("common ancestor");
    EXPECT_TRUE(window.find("organism 0"));
    window.turn_wheel("common ancestor", 6);
    const auto after = window.find("common ancestor");
    ASSERT_TRUE(after);
    EXPECT_LT(std::abs(after->y - before->y), 60) << "the place at the mouse stays";
    EXPECT_FALSE(window.find("organism 0")) << "the newest generation is out of sight";
    window.click("Fit");
    EXPECT_EQ(*window.find("common ancestor"), *before);
    EXPECT_TRUE(window.find("organism 0"));
}

TEST_F(FamilyTreeTest, PlacedOrganismsAreNamed) {
    run(3);
    server.run_to("w", server.state("w").tick() + 1);
    evod::v1::Request get, place;
    get.mutable_get_organism()->set_world("w");
    auto& copy = *place.mutable_place()->add_organisms();
    *copy.mutable_genes() = server.connection->request(get, hang).value().organism().genes();
    place.mutable_place()->set_world("w");
    copy.set_y_px(40);
    bool placed = false;
    for (double x = 40; !placed && x < 400; x += 20) { // another organism may be there
        copy.set_x_px(x);
        placed = core::accepted(server.connection->request(place, hang).value());
    }
    ASSERT_TRUE(placed);
    TreeWindow window{server, "w"};
    window.island_view().options.colour_by = ColourBy::Lineage;
    const auto legend_ends_with = [&](const std::string& text) {
        const auto& snapshot = window.world().feed.view().latest();
        if (!snapshot) {
            return false;
        }
        const Legend legend = legend_of(window.island_view(), *snapshot, std::nullopt, 1);
        return !legend.entries.empty() && legend.entries.back().text == text;
    };
    EXPECT_TRUE(window.draws_until([&] { return legend_ends_with("placed by a user, and their descendants: 1"); }));
    EXPECT_TRUE(window.draws_until([&] { return window.find("organism 20").has_value(); })) << "in the tree";
    EXPECT_EQ(window.lineage().at(4).organisms[20].origin, Lineage::Origin::Placed);
}

TEST_F(FamilyTreeTest, AServerWithoutRunFilesIsExplained) {
    RealServer forgetful{{"--seed", "7", "--keep-nothing"}};
    TreeWindow window{forgetful, "default"};
    ASSERT_TRUE(window.draws_until([&] { return !window.island_view().lineage_problem().empty(); }));
    EXPECT_FALSE(window.find("tree of generation 1"));
}

} // namespace
} // namespace evod::viewer
