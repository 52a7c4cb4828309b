// Plot program: draws the curves of `evod compare`. It runs the script plot_compare, installed in libexec/evod, and
// needs Python with matplotlib.
//
// Threads  one. The caller waits until the script has ended.
#pragma once

#include "server/base/result.h"

#include <string>

namespace evod::commands {

/// Checks that the script can draw. A refusal names the missing package.
base::Result<void> check_plot_program();

/// Draws curves into a file. The format is PNG or PDF if the file name ends with that extension, otherwise SVG.
///
/// curves  path of a CSV file with the columns arm, generation, mean, low, high.
base::Result<void> draw_curves(const std::string& curves, const std::string& title, const std::string& subtitle,
                               const std::string& y_label, const std::string& path);

} // namespace evod::commands
