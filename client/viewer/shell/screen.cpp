#include "client/viewer/shell/screen.h"

#include "client/viewer/drawing/png.h"
#include "client/viewer/shell/display.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>

namespace evod::viewer {

namespace {

// The screen paces the window where it can; this is for where it cannot, and too short to miss a beat at 60 Hz.
constexpr std::chrono::milliseconds frame_min{15};

// Widgets answer in the frame in which they are given an event; what that opens is there in the next.
constexpr unsigned settled_frames = 2;

} // namespace

sf::ContextSettings context_settings() {
    return sf::ContextSettings{0, 0, 0, 3, 3, sf::ContextSettings::Core};
}

/// What a script has hands on.
class Screen::Hands : public Script::Host {
  public:
    Hands(Screen& screen, const Watch* watch, const Stage::Frame& frame, const std::function<void()>& draw)
        : screen_{screen}, watch_{watch}, frame_{frame}, draw_{draw} {}

    void send(const sf::Event& event) override { screen_.played_.push_back(event); }
    std::optional<Point> find(const std::string& widget) const override {
        return screen_.stage_.gui().spots().find(widget);
    }
    const std::vector<std::string>* choices(const std::string& widget) const override {
        return screen_.stage_.gui().spots().choices(widget);
    }
    const Watch* watched() const override { return watch_; }
    std::string save(const std::string& path) override {
        try {
            write_file(path, png_of(screen_.stage_.capture(frame_, draw_)));
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return {};
    }
    void close() override { screen_.window_.close(); }

  private:
    Screen& screen_;
    const Watch* watch_;
    const Stage::Frame& frame_;
    const std::function<void()>& draw_;
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

/// Where no window manager does it, puts the window in the middle of the desktop: SFML puts it lower.
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
    , stage_{scale_of(options)}
    , script_{options.script.value_or(Script{})}
    , script_path_{options.script_path} {
    place(window_);
    window_.setVerticalSyncEnabled(true);
}

bool Screen::poll(sf::Event& event) {
    if (!played_.empty()) {
        event = played_.front();
        played_.pop_front();
    } else if (!window_.pollEvent(event)) {
        return false;
    }
    stage_.gui().handle(event);
    return true;
}

Stage::Frame Screen::frame(Clock::time_point now) const {
    const sf::Vector2u size = window_.getSize();
    return {
        .width_pixels = std::max(size.x, 1u), .height_pixels = std::max(size.y, 1u), .now = now, .interactive = true};
}

void Screen::show(const Watch* watch, const Stage::Frame& frame, const std::function<void()>& draw) {
    draw();
    window_.display();
    Hands hands{*this, watch, frame, draw};
    advance_script(hands, frame.now);
    std::this_thread::sleep_until(frame.now + frame_min);
}

void Screen::advance_script(Hands& hands, Clock::time_point now) {
    settled_count_ = played_.empty() && stage_.gui().settled() ? settled_count_ + 1 : 0;
    if (script_.done() || settled_count_ < settled_frames) {
        return;
    }
    if (const auto advanced = script_.advance(hands, now); !advanced) {
        throw std::runtime_error{script_path_ + ":" + advanced.error().what};
    }
}

} // namespace evod::viewer
