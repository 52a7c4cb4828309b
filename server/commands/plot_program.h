// Plot program: draws the curves of `evod compare`. It is the script plot_compare, which the installation puts beside
// evod, and needs Python with matplotlib.
//
// Threads  one; the caller waits until the script has ended.
#pragma once

#include "server/base/result.h"

#include <string>

namespace evod::commands {

/// Refused where the script cannot draw; the message names the package that is missing.
base::Result<void> check_plot_program();

/// Draws curves into a file: SVG, or PNG or PDF if the name of the file ends so.
///
/// curves  path of a CSV file with the columns arm, generation, mean, low, high.
base::Result<void> draw_curves(const std::string& curves, const std::string& title, const std::string& subtitle,
                               const std::string& y_label, const std::string& path);

} // namespace evod::commands
