// Display: whether there is a screen to draw on, and how fine it is. SFML aborts where there is none.
#pragma once

namespace evod::viewer {

/// Throws std::runtime_error, with what to do, if no window could be opened.
void check_display();

/// How much larger than at 96 dots per inch things have to be on this screen: the desktop's setting, or else what the
/// screen says of itself; 1 where neither is known. In quarters, within 0.5 and 4.
double display_scale();

} // namespace evod::viewer
