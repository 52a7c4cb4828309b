// The panel Plots against evod: it saves the numbers of the server.
//
// Runs under Xvfb.
#include "client/viewer/panels/plots/plots_panel.h"
#include "tests/system/viewer/support/panel_host.h"
#include "tests/system/viewer/support/pixels.h"
#include "tests/system/viewer/support/processes.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <sstream>

namespace evod::viewer {
namespace {

constexpr unsigned width = 700, height = 620;

/// The panel alone, with a mouse.
class Plots {
  public:
    explicit Plots(const std::string& server)
        : world_{{.connection = {.server = core::parse_endpoint(server).value()}, .world = "lab"}} {}

    /// Clicks at this x from the bottom upwards until the file exists.
    bool clicks_until_saved(int x, const std::string& path) {
        host_.draw(); // requests the names of the genes, which the file contains
        EXPECT_TRUE(wait_until([&] { return world_.all_answered(); }, [&] { host_.draw(); }));
        return wait_until([&] { return std::filesystem::exists(path); },
                          [&] {
                              for (int y = height - 5; y > int{height} - 120 && !std::filesystem::exists(path);
                                   y -= 10) {
                                  host_.click(x, y);
                              }
                          });
    }

  private:
    PlotsPanel panel_;
    RunHistory history_;
    IslandView island_view_;
    ViewedWorld world_;
    PanelHost host_{width, height, [this](Gui& gui) {
                        const auto now = std::chrono::steady_clock::now();
                        world_.update(now);
                        ImGui::SetNextWindowPos({0, 0});
                        ImGui::SetNextWindowSize({width, height});
                        ImGui::Begin("Plots");
                        history_.update(world_, now);
                        Panel::Context context{.world = world_, .gui = gui, .now = now, .island_view = island_view_};
                        context.history = &history_;
                        panel_.build(context);
                        ImGui::End();
                    }};
};

struct PlotsTest : testing::Test {
    PlotsTest() { std::filesystem::current_path(folder.file("")); }
    ~PlotsTest() override { std::filesystem::current_path("/"); }

    void make_world() {
        server.make_world(
            {.name = "lab",
             .parameters = {{"island_count", count(2)}, {"population_size", count(20)}, {"generation_s", real(20)}}});
    }
    void run(std::uint64_t generations) {
        evod::v1::Request run;
        run.mutable_run()->set_world("lab");
        run.mutable_run()->set_generations(generations);
        server.ask(run);
    }
    evod::v1::Response answer(const evod::v1::Request& request) {
        return server.connection->request(request, hang).value();
    }
    evod::v1::WorldInfo world() { return server.state("lab"); }
    std::string path_of(const std::string& what, std::uint64_t generation) {
        return folder.file("evoview-lab-" + world().run_id().substr(0, 8) + "-" + what + "-generation-" +
                           std::to_string(generation));
    }
    /// Checks that every number in the file equals the server's.
    void expect_the_servers_numbers(const std::string& path, int generations) {
        std::stringstream text;
        text << std::ifstream{path}.rdbuf();
        const auto read = core::read_history_csv(text.str());
        ASSERT_TRUE(read) << read.error().what;
        const auto names = world().gene_names();
        EXPECT_EQ(read->gene_names, std::vector<std::string>(names.begin(), names.end()));
        evod::v1::Request request;
        request.mutable_get_history()->set_world("lab");
        const evod::v1::History history = answer(request).history();
        ASSERT_EQ(history.generations_size(), 2 * generations);
        ASSERT_EQ(read->rows.size(), static_cast<std::size_t>(2 * generations));
        for (int i = 0; i < history.generations_size(); ++i) {
            const auto& statistics = history.generations(i);
            const auto& row = read->rows[static_cast<std::size_t>(i)];
            const auto numbers = core::history_numbers(statistics);
            ASSERT_EQ(row.size(), numbers.size());
            for (std::size_t column = 0; column < row.size(); ++column) {
                // A missing account is NaN in both.
                EXPECT_TRUE(row[column] == numbers[column] || (std::isnan(row[column]) && std::isnan(numbers[column])))
                    << "column " << column << ": " << row[column] << ", not " << numbers[column];
            }
            EXPECT_EQ(row[5], statistics.fitness_best());
            EXPECT_EQ(row[11], statistics.alive_count());
        }
    }

    TemporaryFolder folder;
    RealServer server{{"--seed", "7"}};
};

constexpr int csv_button_x = 70, png_button_x = 145;

TEST_F(PlotsTest, SavesTheNumbersOfTheServer) {
    make_world();
    run(12);
    Plots plots{server.address()};
    ASSERT_TRUE(plots.clicks_until_saved(csv_button_x, path_of("history", 12) + ".csv"));
    expect_the_servers_numbers(path_of("history", 12) + ".csv", 12);
    run(3); // arrives by events
    ASSERT_TRUE(plots.clicks_until_saved(csv_button_x, path_of("history", 15) + ".csv"));
    expect_the_servers_numbers(path_of("history", 15) + ".csv", 15);

    evod::v1::Request reset;
    reset.mutable_reset_world()->set_world("lab");
    server.ask(reset);
    run(2);
    ASSERT_TRUE(plots.clicks_until_saved(csv_button_x, path_of("history", 2) + ".csv"));
    expect_the_servers_numbers(path_of("history", 2) + ".csv", 2);
}

TEST_F(PlotsTest, SavesAnImageOfThePlot) {
    make_world();
    run(8);
    Plots plots{server.address()};
    const std::string path = path_of("fitness", 8) + ".png";
    ASSERT_TRUE(plots.clicks_until_saved(png_button_x, path));
    sf::Image image;
    ASSERT_TRUE(image.loadFromFile(path));
    EXPECT_EQ(image.getSize(), (sf::Vector2u{1200, 700}));
    EXPECT_GT(count(image, palette::plot_background), 300'000u);
    EXPECT_GT(count(image, palette::series_vermilion), 200u) << "the line of the best";
    EXPECT_GT(count(image, palette::series_blue), 200u) << "the line of the mean";
}

TEST_F(PlotsTest, ATypedImageSizeIsClamped) {
    make_world();
    run(3);
    std::ofstream{folder.file("script")} << R"(wait snapshot
key F7
wait widget "3 generations, up to 3"
click "image width"
key Q
key Ctrl+A
type 5
key Enter
set "image height" 300
click "Save PNG"
quit
)";
    const Ran ran = run_evoview(server.address() + " --world lab --script " + folder.file("script"));
    ASSERT_EQ(ran.status, 0) << ran.output;
    sf::Image image;
    ASSERT_TRUE(image.loadFromFile(path_of("fitness", 3) + ".png"));
    EXPECT_EQ(image.getSize(), (sf::Vector2u{200, 300}));
}

TEST_F(PlotsTest, SavesTheTabThatAScriptClicked) {
    make_world();
    run(3);
    std::ofstream{folder.file("script")} << R"(wait snapshot
key F7
wait widget "3 generations, up to 3"
click Selection
click "Save PNG"
quit
)";
    const Ran ran = run_evoview(server.address() + " --world lab --script " + folder.file("script"));
    ASSERT_EQ(ran.status, 0) << ran.output;
    sf::Image image;
    EXPECT_TRUE(image.loadFromFile(path_of("selection", 3) + ".png"));
}

TEST_F(PlotsTest, AChangeOfParametersIsMarked) {
    make_world();
    run(3);
    const auto saved = [&](std::uint64_t generation) {
        std::ofstream{folder.file("script")} << "wait snapshot\nkey F7\nwait widget \"" << generation
                                             << " generations, up to " << generation
                                             << "\"\nclick \"Save PNG\"\nscreenshot window.png\nquit\n";
        const Ran ran = run_evoview(server.address() + " --world lab --script " + folder.file("script"));
        EXPECT_EQ(ran.status, 0) << ran.output;
        sf::Image plot, window;
        EXPECT_TRUE(plot.loadFromFile(path_of("fitness", generation) + ".png"));
        EXPECT_TRUE(window.loadFromFile(folder.file("window.png")));
        return std::pair{count(plot, palette::plot_mark), count(window, palette::plot_mark)};
    };
    EXPECT_EQ(saved(3), std::pair(std::size_t{0}, std::size_t{0})) << "no parameter has changed";
    evod::v1::Request change; // before the viewer connects
    change.mutable_set_parameters()->set_world("lab");
    auto& assignment = *change.mutable_set_parameters()->add_parameters();
    assignment.set_name("mutation_chance");
    assignment.mutable_value()->set_real(0.2);
    server.ask(change);
    run(3);
    const auto [on_plot, in_window] = saved(6);
    EXPECT_GT(on_plot, 150u) << "a dashed line as high as the plot, and a triangle";
    EXPECT_GT(in_window, 80u) << "in the panel and in the sidebar's curve";
}

TEST_F(PlotsTest, AScriptComparesWithAnotherWorld) {
    make_world();
    run(3);
    server.make_world({.name = "other", .seed = 9, .parameters = {}});
    std::ofstream{folder.file("script")} << R"(wait snapshot
key F7
wait widget "3 generations, up to 3"
set compare "world other"
click Genes
set gene body_size
click "living only"
quit
)";
    const Ran ran = run_evoview(server.address() + " --world lab --script " + folder.file("script"));
    EXPECT_EQ(ran.status, 0) << ran.output;
}

/// A plot that fills the window, with a mouse.
struct PlotUnderTheMouse {
    Plot plot;
    PlotView view;
    float scrolled = 0;
    PanelHost host{width, height, [this](Gui&) {
                       ImGui::SetNextWindowPos({0, 0});
                       ImGui::SetNextWindowSize({width, height});
                       ImGui::Begin("plot");
                       plot_widget("plot", plot, view, height - 50);
                       ImGui::Dummy({1, height}); // something to scroll to
                       scrolled = ImGui::GetScrollY();
                       ImGui::End();
                   }};

    void move(int x) { host.move(x, height / 2); }
};

TEST(PlotWidget, ItsNoteIsBesideThePlot) {
    const std::vector<double> x{1, 2, 3}, y{4, 9, 5};
    const std::vector<Mark> marks{{2, "generation 2: mutation_chance 0.01 → 0.2 by alice"}};
    Plot plot{.x_label = "generation", .series = {{.name = "y", .x = x, .y = y}}, .marks = {{marks}}};
    PlotView view;
    constexpr int left = 420; // of the plot
    PanelHost host{width, height, [&](Gui&) {
                       ImGui::SetNextWindowPos({left, 0});
                       ImGui::SetNextWindowSize({width - left, height});
                       ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
                       ImGui::Begin("plot", nullptr, ImGuiWindowFlags_NoDecoration);
                       ImGui::PopStyleVar();
                       plot_widget("plot", plot, view, height);
                       ImGui::End();
                   }};
    host.draw();
    const sf::Image before = host.draw();
    const auto changed = [&](int mouse) {
        host.move(mouse, height / 2);
        host.draw();
        const sf::Image now = host.draw();
        std::pair<std::size_t, std::size_t> pixels{0, 0}; // beside the plot, on the plot
        for (unsigned row = 0; row < height; ++row) {
            for (unsigned column = 0; column < width; ++column) {
                if (pixel_at(now, column, row) != pixel_at(before, column, row)) {
                    ++(column < left ? pixels.first : pixels.second);
                }
            }
        }
        return pixels;
    };
    const auto [beside, on] = changed(left + 60);
    EXPECT_GT(beside, 500u) << "the note";
    EXPECT_LT(on, 2 * height + 50u) << "only the cursor and its dot";
    EXPECT_GT(on, height / 2) << "the cursor";
    const auto at_mark = changed(left + (width - left) / 2 + 10);
    EXPECT_GT(at_mark.first, beside + 500) << "the note also contains the change of generation 2";
}

TEST(PlotWidget, ZoomsMovesAndFitsWithTheMouse) {
    std::vector<double> x, y;
    for (int i = 1; i <= 1000; ++i) {
        x.push_back(i);
        y.push_back(i % 7);
    }
    PlotUnderTheMouse on;
    on.plot = {.title = "", .x_label = "generation", .y_label = "", .series = {{.name = "y", .x = x, .y = y}}};
    on.host.draw();
    on.move(width / 2);
    EXPECT_EQ(on.view.x, std::nullopt) << "everything";
    on.host.turn_wheel(6);
    ASSERT_TRUE(on.view.x);
    const Range zoomed = *on.view.x;
    EXPECT_NEAR(zoomed.width(), 999 / std::pow(1.25, 6), 1e-9);
    EXPECT_TRUE(zoomed.contains(500)) << "what was under the mouse";

    on.host.button(sf::Event::MouseButtonPressed);
    on.move(width / 2 - 100);
    on.host.button(sf::Event::MouseButtonReleased);
    ASSERT_TRUE(on.view.x);
    EXPECT_NEAR(on.view.x->width(), zoomed.width(), 1e-9);
    EXPECT_GT(on.view.x->min, zoomed.min + 0.1 * zoomed.width()) << "dragging to the left shows later ones";
    on.move(width / 2);
    EXPECT_GT(on.view.x->min, zoomed.min) << "the button is released";

    for (const auto type : {sf::Event::MouseButtonPressed, sf::Event::MouseButtonReleased,
                            sf::Event::MouseButtonPressed, sf::Event::MouseButtonReleased}) {
        on.host.button(type);
    }
    EXPECT_EQ(on.view.x, std::nullopt);
    on.host.turn_wheel(-3);
    EXPECT_EQ(on.view.x, std::nullopt) << "the whole range is the limit";
    on.host.draw();
    EXPECT_EQ(on.scrolled, 0) << "the window does not scroll";
}

} // namespace
} // namespace evod::viewer
