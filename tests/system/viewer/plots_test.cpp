// The panel of plots against evod: what it saves is what the server says.
//
// Runs under Xvfb.
#include "client/viewer/drawing/offscreen.h"
#include "client/viewer/panels/plots/plots_panel.h"
#include "client/viewer/shell/display.h"
#include "client/viewer/shell/window.h"
#include "tests/system/viewer/processes.h"

#include <SFML/Window/Context.hpp>
#include <gtest/gtest.h>
#include <imgui.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <sstream>
#include <thread>

namespace evod::viewer {
namespace {

constexpr unsigned width = 700, height = 620;

/// A person who looks at nothing but the panel, and clicks.
class Person {
  public:
    explicit Person(const std::string& server)
        : context_{context_settings(), 1, 1}
        , watch_{{.connection = {.server = link::parse_endpoint(server).value()}, .world = "lab"}} {}

    sf::Image look() {
        watch_.update(std::chrono::steady_clock::now());
        return draw_off_screen(width, height, [this] {
            gui_.begin(width, height, 0.02);
            ImGui::SetNextWindowPos({0, 0});
            ImGui::SetNextWindowSize({width, height});
            ImGui::Begin("Plots");
            Panel::Context context{watch_, gui_, std::chrono::steady_clock::now(), sight_};
            panel_.build(context);
            ImGui::End();
            gui_.draw();
        });
    }

    void click(int x, int y) {
        sf::Event event{};
        event.type = sf::Event::MouseMoved;
        event.mouseMove = {x, y};
        gui_.handle(event);
        look();
        for (const auto type : {sf::Event::MouseButtonPressed, sf::Event::MouseButtonReleased}) {
            event.type = type;
            event.mouseButton = {sf::Mouse::Left, x, y};
            gui_.handle(event);
            look();
        }
    }

    /// Clicks at this x all the way up from the bottom until there is the file.
    bool clicks_until_saved(int x, const std::string& path) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds{30};
        while (std::chrono::steady_clock::now() < end) {
            for (int y = height - 5; y > static_cast<int>(height) - 120; y -= 10) {
                click(x, y);
                if (std::filesystem::exists(path)) {
                    return true;
                }
            }
        }
        return false;
    }

  private:
    sf::Context context_;
    Gui gui_;
    PlotsPanel panel_;
    Sight sight_;
    Watch watch_;
};

struct PlotsTest : testing::Test {
    PlotsTest() { std::filesystem::current_path(folder.file("")); }
    ~PlotsTest() override { std::filesystem::current_path("/"); }

    void make_world() {
        evod::v1::Request create, speed;
        create.mutable_create_world()->set_name("lab");
        create.mutable_create_world()->set_seed(7);
        const auto add = [&](const char* name) {
            auto& parameter = *create.mutable_create_world()->add_parameters();
            parameter.set_name(name);
            return parameter.mutable_value();
        };
        add("island_count")->set_count(2);
        add("population_size")->set_count(20);
        add("generation_s")->set_real(20);
        server.ask(create);
        speed.mutable_set_speed()->set_world("lab");
        speed.mutable_set_speed()->mutable_speed()->set_max(true);
        server.ask(speed);
    }
    void run(std::uint64_t generations) {
        evod::v1::Request run;
        run.mutable_run()->set_world("lab");
        run.mutable_run()->set_generations(generations);
        server.ask(run);
    }
    evod::v1::Response answer(const evod::v1::Request& request) { return server.connection->request(request).value(); }
    evod::v1::WorldInfo world() {
        evod::v1::Request request;
        request.mutable_get_statistics()->set_world("lab");
        return answer(request).statistics().world();
    }
    std::string path_of(const std::string& what, std::uint64_t generation) {
        return folder.file("evoview-lab-" + world().run_id().substr(0, 8) + "-" + what + "-generation-" +
                           std::to_string(generation));
    }
    /// Every number in the file is the server's.
    void expect_the_servers_numbers(const std::string& path, int generations) {
        std::stringstream text;
        text << std::ifstream{path}.rdbuf();
        const auto read = link::read_history_csv(text.str());
        ASSERT_TRUE(read) << read.error().what;
        const auto names = world().gene_names();
        EXPECT_EQ(read->gene_names, std::vector<std::string>(names.begin(), names.end()));
        evod::v1::Request request;
        request.mutable_get_history()->set_world("lab");
        const evod::v1::History history = answer(request).history();
        ASSERT_EQ(history.generations_size(), 2 * generations);
        ASSERT_EQ(read->rows.size(), static_cast<std::size_t>(2 * generations));
        for (int i = 0; i < history.generations_size(); ++i) {
            const auto& told = history.generations(i);
            const auto& row = read->rows[static_cast<std::size_t>(i)];
            EXPECT_EQ(row, link::history_numbers(told));
            EXPECT_EQ(row[5], told.fitness_best());
            EXPECT_EQ(row[11], told.alive_count());
        }
    }

    TemporaryFolder folder;
    RealServer server{{"--seed", "7"}};
};

constexpr int csv_button_x = 40, png_button_x = 130;

TEST_F(PlotsTest, WhatIsSavedIsWhatTheServerSays) {
    make_world();
    run(12);
    Person person{server.address()};
    ASSERT_TRUE(person.clicks_until_saved(csv_button_x, path_of("history", 12) + ".csv"));
    expect_the_servers_numbers(path_of("history", 12) + ".csv", 12);
    run(3); // heard of as it happens
    ASSERT_TRUE(person.clicks_until_saved(csv_button_x, path_of("history", 15) + ".csv"));
    expect_the_servers_numbers(path_of("history", 15) + ".csv", 15);

    evod::v1::Request reset;
    reset.mutable_reset_world()->set_world("lab");
    server.ask(reset);
    run(2);
    ASSERT_TRUE(person.clicks_until_saved(csv_button_x, path_of("history", 2) + ".csv"));
    expect_the_servers_numbers(path_of("history", 2) + ".csv", 2);
}

TEST_F(PlotsTest, APictureOfThePlotIsSaved) {
    make_world();
    run(8);
    Person person{server.address()};
    const std::string path = path_of("fitness", 8) + ".png";
    ASSERT_TRUE(person.clicks_until_saved(png_button_x, path));
    sf::Image image;
    ASSERT_TRUE(image.loadFromFile(path));
    EXPECT_EQ(image.getSize(), (sf::Vector2u{1200, 700}));
    const auto count = [&](Colour colour) {
        unsigned found = 0;
        for (unsigned y = 0; y < 700; ++y) {
            for (unsigned x = 0; x < 1200; ++x) {
                found += image.getPixel(x, y) == sf::Color{colour.red, colour.green, colour.blue};
            }
        }
        return found;
    };
    EXPECT_GT(count(palette::plot_background), 300'000u);
    EXPECT_GT(count(palette::series_vermilion), 200u) << "the line of the best";
    EXPECT_GT(count(palette::series_blue), 200u) << "the line of the mean";
}

/// A plot that fills the window, and a mouse.
class PlotUnderTheMouse {
  public:
    void frame() {
        draw_off_screen(width, height, [this] {
            gui_.begin(width, height, 0.02);
            ImGui::SetNextWindowPos({0, 0});
            ImGui::SetNextWindowSize({width, height});
            ImGui::Begin("plot");
            plot_widget("plot", plot, view, height - 50);
            ImGui::Dummy({1, height}); // something to scroll to
            scrolled_ = ImGui::GetScrollY();
            ImGui::End();
            gui_.draw();
        });
    }
    float scrolled() {
        frame();
        return scrolled_;
    }
    void move(int x) {
        sf::Event event{};
        event.type = sf::Event::MouseMoved;
        event.mouseMove = {x, height / 2};
        gui_.handle(event);
        frame();
    }
    void turn_wheel(float notches) {
        sf::Event event{};
        event.type = sf::Event::MouseWheelScrolled;
        event.mouseWheelScroll = {sf::Mouse::VerticalWheel, notches, 0, 0};
        gui_.handle(event);
        frame();
    }
    void button(sf::Event::EventType type) {
        sf::Event event{};
        event.type = type;
        event.mouseButton = {sf::Mouse::Left, 0, 0};
        gui_.handle(event);
        frame();
    }

    Plot plot;
    PlotView view;

  private:
    sf::Context context_{context_settings(), 1, 1};
    Gui gui_;
    float scrolled_ = 0;
};

TEST(PlotWidget, TheWheelZoomsDraggingMovesAndADoubleClickFits) {
    std::vector<double> x, y;
    for (int i = 1; i <= 1000; ++i) {
        x.push_back(i);
        y.push_back(i % 7);
    }
    PlotUnderTheMouse on;
    on.plot = {.title = "", .x_label = "generation", .y_label = "", .series = {{.name = "y", .x = x, .y = y}}};
    on.frame();
    on.move(width / 2);
    EXPECT_EQ(on.view.x, std::nullopt) << "everything";
    on.turn_wheel(6);
    ASSERT_TRUE(on.view.x);
    const Range zoomed = *on.view.x;
    EXPECT_NEAR(zoomed.width(), 999 / std::pow(1.25, 6), 1e-9);
    EXPECT_TRUE(zoomed.contains(500)) << "what was under the mouse";

    on.button(sf::Event::MouseButtonPressed);
    on.move(width / 2 - 100);
    on.button(sf::Event::MouseButtonReleased);
    ASSERT_TRUE(on.view.x);
    EXPECT_NEAR(on.view.x->width(), zoomed.width(), 1e-9);
    EXPECT_GT(on.view.x->min, zoomed.min + 0.1 * zoomed.width()) << "dragged to the left: later ones come in";
    on.move(width / 2);
    EXPECT_GT(on.view.x->min, zoomed.min) << "the button is up";

    for (const auto type : {sf::Event::MouseButtonPressed, sf::Event::MouseButtonReleased,
                            sf::Event::MouseButtonPressed, sf::Event::MouseButtonReleased}) {
        on.button(type);
    }
    EXPECT_EQ(on.view.x, std::nullopt);
    on.turn_wheel(-3);
    EXPECT_EQ(on.view.x, std::nullopt) << "there is no more than everything";
    EXPECT_EQ(on.scrolled(), 0) << "the window stays where it is";
}

} // namespace
} // namespace evod::viewer
