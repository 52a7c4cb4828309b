// evoview: opens a window with a world, or saves a screenshot or a recording.
#include "client/viewer/shell/display.h"
#include "client/viewer/shell/options.h"
#include "client/viewer/shell/recorder.h"
#include "client/viewer/shell/screenshot.h"
#include "client/viewer/shell/window.h"
#include "proto/command_line/exhaustion.h"

#include <exception>
#include <iostream>

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
            Screen screen{options};
            Window{screen, options}.run();
        }
    } catch (const std::exception& error) {
        std::cerr << "evoview: " << error.what() << '\n';
        return 1;
    }
    return 0;
}
