// evoview: options → a window, or a screenshot, or a recording → exit status.
#include "client/viewer/display.h"
#include "client/viewer/options.h"
#include "client/viewer/record.h"
#include "client/viewer/screenshot.h"
#include "client/viewer/window.h"

#include <exception>
#include <iostream>

int main(int argc, char** argv) {
    using namespace evod::viewer;
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
            Window{options}.run();
        }
    } catch (const std::exception& error) {
        std::cerr << "evoview: " << error.what() << '\n';
        return 1;
    }
    return 0;
}
