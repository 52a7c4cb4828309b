// evoview: opens a window with the start screen or with worlds, or saves a screenshot or a recording.
#include "client/viewer/shell/display.h"
#include "client/viewer/shell/options.h"
#include "client/viewer/shell/recorder.h"
#include "client/viewer/shell/screenshot.h"
#include "client/viewer/shell/start_screen.h"
#include "client/viewer/shell/window.h"
#include "proto/command_line/exhaustion.h"

#include <exception>
#include <iostream>
#include <utility>

namespace evod::viewer {
namespace {

void run(Options options) {
    Screen screen{options};
    StartScreen start{screen, options.connection};
    bool show_start = options.start, must_connect = !options.server_given, connected = false;
    while (screen.window().isOpen()) {
        if (show_start) {
            const auto chosen = start.run();
            if (!chosen) {
                return;
            }
            if (connected) {
                Options next; // the other options applied to the previous server
                next.skin = options.skin;
                next.background = options.background;
                options = std::move(next);
            }
            options.connection = *chosen;
            must_connect = true;
        }
        Window::Ending ending;
        {
            Window window{screen, options};
            ending = window.run(must_connect, [&] {
                connected = true;
                start.remember(options.connection.server);
            });
        }
        screen.renderer().panels().begin_session(); // requests to the previous server stay unanswered
        show_start = ending.to_start_screen;
        start.set_reason(ending.reason);
    }
}

} // namespace
} // namespace evod::viewer

int main(int argc, char** argv) {
    using namespace evod::viewer;
    evod::command_line::end_when_exhausted("evoview: out of memory or threads\n", 1);
    try {
        const auto parsed = parse_options(argc, argv);
        if (const int* status = std::get_if<int>(&parsed)) {
            return *status;
        }
        const auto& options = std::get<Options>(parsed);
        check_display();
        if (options.screenshot) {
            take_screenshot(options, *options.screenshot);
        } else if (options.record) {
            record(options, *options.record);
        } else {
            run(options);
        }
    } catch (const std::exception& error) {
        std::cerr << "evoview: " << error.what() << '\n';
        return 1;
    }
    return 0;
}
