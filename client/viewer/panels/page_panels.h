// Page panels: the panels that only the page in the browser has. Their keys and widgets belonged to evoview once; keys
// and scripts that name them get an answer that leads to the page.
//
// Owner        none: functions.
// Threads      any.
#pragma once

#include <string>
#include <string_view>

namespace evod::viewer {

/// The tab of the page that took over this function key of evoview: "Glass box" for 8; empty: none.
std::string_view page_panel_at(unsigned function_key);
/// The tab of the page that has what a script names: "Glass box" for "Glass box/Play" and for "hold the world"; empty:
/// none.
std::string_view page_panel_with(std::string_view widget);

/// "open http://127.0.0.1:7745/#world=default", or how to serve the page if `link` is empty.
std::string way_to_page(std::string_view link);
/// "The panel Glass box is in the browser page: open http://127.0.0.1:7745/#world=default and choose Glass box"
///
/// link  to the page; empty: the server serves none that this machine can reach
std::string where_in_page(std::string_view panel, std::string_view link);

} // namespace evod::viewer
