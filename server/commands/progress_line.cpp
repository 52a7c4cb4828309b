#include "server/commands/progress_line.h"

#include "server/commands/json_lines.h"

#include <cmath>

namespace evod::commands {

void ProgressLine::print_share(double share) {
    print_json({{"progress", share}});
}

std::string time_left(double share, double seconds_gone) {
    const double seconds = seconds_gone / share * (1 - share);
    char text[48];
    if (seconds < 120) {
        std::snprintf(text, sizeof text, "%.0f s left", seconds);
    } else if (seconds < 2 * 3600) {
        std::snprintf(text, sizeof text, "%.0f min left", seconds / 60);
    } else {
        std::snprintf(text, sizeof text, "%.0f h %02.0f min left", std::floor(seconds / 3600),
                      std::floor(std::fmod(seconds, 3600) / 60));
    }
    return text;
}

} // namespace evod::commands
