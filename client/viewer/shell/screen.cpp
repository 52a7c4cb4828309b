#include "client/viewer/shell/screen.h"

#include "client/viewer/drawing/png.h"
#include "client/viewer/panels/page_panels.h"
#include "client/viewer/shell/display.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>

namespace evod::viewer {

namespace {

// Number of frames after an event until its effect is visible. Widgets react in the first frame; a list or dialog that
// they open appears in the second.
constexpr unsigned settled_frames = 2;

} // namespace

sf::ContextSettings context_settings() {
    return sf::ContextSettings{0, 0, 0, 3, 3, sf::ContextSettings::Core};
}

/// Gives a script access to the window.
class Screen::ScriptHost : public Script::Host {
  public:
    ScriptHost(Screen& screen, WorldView& view, const WindowRenderer::Frame& frame)
        : screen_{screen}, view_{view}, frame_{frame} {}

    void send(const sf::Event& event) override { screen_.script_events_.push_back(event); }
    std::vector<const MarkedWidget*> find(const std::string& name) const override { return widgets().find(name); }
    std::string absence(const std::string& name) const override {
        const std::string_view panel = page_panel_with(name);
        return panel.empty() ? "" : where_in_page(panel, view_.world.live_link());
    }
    void reveal(const std::string& widget) override { widgets().reveal(widget); }
    unsigned hovered() const override { return widgets().hovered(); }
    bool covered() const override { return screen_.renderer_.gui().captured().mouse; }
    std::optional<std::string> typed_text() const override { return screen_.renderer_.gui().typed_text(); }
    std::string key_problem() const override { return screen_.key_problem_; }
    std::optional<Point> locate(const Script::IslandPlace& place) const override {
        const codec::ReceivedSnapshot* snapshot = view_.world.feed.snapshot();
        if (snapshot == nullptr) {
            return std::nullopt;
        }
        Point at{place.at.x * snapshot->about.width_px(), place.at.y * snapshot->about.height_px()};
        if (place.organism) {
            const auto index = snapshot->entities->organisms.index_of(*place.organism);
            if (!index) {
                return std::nullopt;
            }
            const core::SnapshotInterpolator& view = view_.world.feed.view();
            const auto [x, y] = view.organisms_at(screen_.renderer_.drawn_blend(view))[*index];
            at = {x, y};
        }
        const Point screen = view_.camera().to_screen(at);
        return view_.camera().viewport().contains(screen) ? std::optional{screen} : std::nullopt;
    }
    std::optional<std::uint32_t> selected() const override { return view_.world.feed.selected(); }
    const ViewedWorld* world() const override { return &view_.world; }
    std::string save(const std::string& path) override {
        try {
            write_file(path, png_of(screen_.renderer_.capture(view_, frame_)));
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return {};
    }
    void close() override { screen_.window_.close(); }

  private:
    WidgetPositions& widgets() const { return screen_.renderer_.gui().widget_positions(); }
    Screen& screen_;
    WorldView& view_;
    const WindowRenderer::Frame& frame_;
};

namespace {

double scale_of(const Options& options) {
    return options.scale ? *options.scale : display_scale();
}

sf::VideoMode mode_of(const Options& options) {
    Options::Size size = size_of(options, scale_of(options));
    if (const auto whole = desktop(); whole && !options.size) {
        size = {std::min(size.width, whole->width), std::min(size.height, whole->height)};
    }
    return {size.width, size.height};
}

/// Centres the window on the desktop if there is no window manager. Without one, SFML places the window lower.
void place(sf::Window& window) {
    const auto whole = desktop();
    if (!whole || whole->managed) {
        return;
    }
    const auto margin = [](unsigned of, unsigned taken) { return of > taken ? static_cast<int>((of - taken) / 2) : 0; };
    const sf::Vector2u size = window.getSize();
    window.setPosition({margin(whole->width, size.x), margin(whole->height, size.y)});
}

} // namespace

Screen::Screen(const Options& options)
    : window_{mode_of(options), "evoview", sf::Style::Default, context_settings()}
    , renderer_{scale_of(options)}
    , script_{options.script.value_or(Script{})}
    , script_path_{options.script_path} {
    place(window_);
    window_.setVerticalSyncEnabled(true);
}

bool Screen::poll(sf::Event& event) {
    event_from_script_ = !script_events_.empty();
    if (event_from_script_) {
        event = script_events_.front();
        script_events_.pop_front();
    } else if (!window_.pollEvent(event)) {
        return false;
    }
    renderer_.gui().handle(event);
    return true;
}

void Screen::report_key(std::string problem) {
    if (event_from_script_) {
        key_problem_ = std::move(problem);
    }
}

WindowRenderer::Frame Screen::frame(Clock::time_point now) const {
    const sf::Vector2u size = window_.getSize();
    return {
        .width_pixels = std::max(size.x, 1u), .height_pixels = std::max(size.y, 1u), .now = now, .interactive = true};
}

void Screen::show(WorldView& view, const WindowRenderer::Frame& frame) {
    renderer_.draw(view, frame);
    window_.display();
    ScriptHost host{*this, view, frame};
    advance_script(host, frame.now);
    std::this_thread::sleep_until(frame.now + frame_min);
}

void Screen::advance_script(ScriptHost& host, Clock::time_point now) {
    settled_count_ = script_events_.empty() && renderer_.gui().settled() ? settled_count_ + 1 : 0;
    if (script_.done() || settled_count_ < settled_frames) {
        return;
    }
    if (const auto advanced = script_.advance(host, now); !advanced) {
        throw std::runtime_error{script_path_ + ":" + advanced.error().what};
    }
}

} // namespace evod::viewer
