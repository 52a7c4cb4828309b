// Display: whether there is a screen to draw on. SFML aborts where there is none.
#pragma once

namespace evod::viewer {

/// Throws std::runtime_error, with what to do, if no window could be opened.
void check_display();

} // namespace evod::viewer
