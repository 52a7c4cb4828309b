// evoview against evod: what it draws is what the server says, and its keys command the world.
//
// Runs under Xvfb.
#include "tests/system/viewer/expected_picture.h"
#include "tests/system/viewer/processes.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/keysym.h>
#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(RealServer, EveryPixelOfAScreenshotIsWhatTheServerSays) {
    RealServer server{{"--seed", "7", "--speed", "max"}};
    evod::v1::Request create, speed, run;
    create.mutable_create_world()->set_name("room");
    create.mutable_create_world()->set_seed(7);
    for (const auto& [name, count] : {std::pair{"obstacle_count", 6u}, {"crate_count", 9u}, {"population_size", 60u}}) {
        auto& parameter = *create.mutable_create_world()->add_parameters();
        parameter.set_name(name);
        parameter.mutable_value()->set_count(count);
    }
    server.ask(create);
    speed.mutable_set_speed()->set_world("room");
    speed.mutable_set_speed()->mutable_speed()->set_max(true);
    server.ask(speed);
    for (const std::string world : {"default", "room"}) {
        constexpr std::uint64_t tick = 601;
        run.mutable_run_until_tick()->set_world(world);
        run.mutable_run_until_tick()->set_tick(tick);
        server.ask(run);
        evod::v1::SubscribeSnapshots subscription;
        subscription.set_world(world);
        subscription.set_rate_hz(60);
        const auto pictures = server.connection->subscribe(subscription);
        std::shared_ptr<const wire::Picture> picture;
        ASSERT_TRUE(comes_true([&] {
            const auto newer = server.connection->take_picture(pictures);
            picture = newer ? newer : picture;
            return picture && picture->about.tick() == tick;
        }));
        const TemporaryFolder folder;
        const std::string path = folder.file("picture.png");
        std::string arguments = "--server " + server.address();
        arguments.append(" --world ").append(world).append(" --screenshot ").append(path);
        arguments.append(" --at-tick ").append(std::to_string(tick));
        const Ran ran = run_evoview(arguments);
        ASSERT_EQ(ran.status, 0) << ran.output;
        sf::Image image;
        ASSERT_TRUE(image.loadFromFile(path));
        const ExpectedPicture expected{*picture, camera_of(picture->about, 1280, 720)};
        EXPECT_GT(expected.count(palette::background), 500'000u);
        // A ring of radius 4 px has dozens of whole pixels, a disc more.
        EXPECT_GT(expected.count(palette::organism), 10 * picture->organisms.id.size());
        EXPECT_GT(expected.count(palette::food), 10 * picture->food.id.size());
        EXPECT_GT(expected.count(palette::poison), 10 * picture->poison.id.size());
        const auto mismatch = expected.compare(image);
        EXPECT_EQ(mismatch.count, 0u) << world << " " << mismatch.first;
    }
}

/// A person at the window of evoview.
class Person {
  public:
    Person() : display_{XOpenDisplay(nullptr)} {
        // A look at a window that is just being moved or drawn anew fails; whoever looks then looks again.
        XSetErrorHandler([](Display*, XErrorEvent*) { return 0; });
    }
    ~Person() { XCloseDisplay(display_); }

    bool finds_window() {
        return comes_true([this] {
            Window root, parent, *children = nullptr;
            unsigned count = 0;
            XQueryTree(display_, DefaultRootWindow(display_), &root, &parent, &children, &count);
            for (unsigned i = 0; i < count; ++i) {
                char* name = nullptr;
                if (XFetchName(display_, children[i], &name) != 0 && name != nullptr) {
                    window_ = std::string{name} == "evoview" ? children[i] : window_;
                    XFree(name);
                }
            }
            if (children != nullptr) {
                XFree(children);
            }
            // It has its name before it is on the screen, and only there can it be looked at.
            XWindowAttributes attributes{};
            return window_ != 0 && XGetWindowAttributes(display_, window_, &attributes) != 0 &&
                   attributes.map_state == IsViewable;
        });
    }

    bool sees(Colour colour) {
        return comes_true([&] {
            XImage* image = XGetImage(display_, window_, 0, 0, 800, 500, AllPlanes, ZPixmap);
            const unsigned long wanted = (static_cast<unsigned long>(colour.red) << 16) |
                                         (static_cast<unsigned long>(colour.green) << 8) | colour.blue;
            unsigned count = 0;
            for (int y = 0; image != nullptr && y < image->height; ++y) {
                for (int x = 0; x < image->width; ++x) {
                    count += (XGetPixel(image, x, y) & 0xffffff) == wanted;
                }
            }
            if (image != nullptr) {
                XDestroyImage(image);
            }
            return count > 50;
        });
    }

    void press(KeySym key, bool shift = false) {
        XEvent event{};
        event.xkey.display = display_;
        event.xkey.window = window_;
        event.xkey.root = DefaultRootWindow(display_);
        event.xkey.same_screen = True;
        event.xkey.keycode = XKeysymToKeycode(display_, key);
        event.xkey.state = shift ? ShiftMask : 0;
        for (const int type : {KeyPress, KeyRelease}) {
            event.xkey.type = type;
            event.xkey.time = time_ += 20;
            XSendEvent(display_, window_, True, type == KeyPress ? KeyPressMask : KeyReleaseMask, &event);
        }
        XFlush(display_);
    }

  private:
    Display* display_;
    Window window_ = 0;
    Time time_ = 1000;
};

TEST(RealServer, KeysCommandTheWorld) {
    RealServer server{{"--seed", "7"}};
    Process evoview{EVOVIEW, {"--server", server.address(), "--size", "800x500"}};
    Person person;
    ASSERT_TRUE(person.finds_window());
    ASSERT_TRUE(person.sees(palette::organism));
    const auto becomes = [&](auto condition) { return comes_true([&] { return condition(server.state()); }); };

    person.press(XK_space);
    EXPECT_TRUE(becomes([](const auto& world) { return world.state() == evod::v1::RUN_STATE_RUNNING; }));
    person.press(XK_space);
    EXPECT_TRUE(becomes([](const auto& world) { return world.state() == evod::v1::RUN_STATE_PAUSED; }));
    const std::uint64_t tick = server.state().tick();
    person.press(XK_period);
    EXPECT_TRUE(becomes([&](const auto& world) { return world.tick() == tick + 1; }));
    person.press(XK_period, true);
    EXPECT_TRUE(becomes(
        [&](const auto& world) { return world.tick() == tick + 61 && world.state() == evod::v1::RUN_STATE_PAUSED; }));
    person.press(XK_equal, true);
    EXPECT_TRUE(becomes([](const auto& world) { return world.speed().real_time_factor() == 2; }));
    person.press(XK_m);
    EXPECT_TRUE(becomes([](const auto& world) { return world.speed().max(); }));
    person.press(XK_minus);
    EXPECT_TRUE(becomes([](const auto& world) { return world.speed().real_time_factor() == 2; }));
    EXPECT_EQ(server.state().tick(), tick + 61);
    person.press(XK_q);
    EXPECT_EQ(evoview.wait(), 0);
}

} // namespace
} // namespace evod::viewer
