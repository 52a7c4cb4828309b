// Off-screen drawing: renders into an image, independent of the size and visibility of the window.
//
// Owner        none: a function.
// Threads      the thread whose OpenGL context is current.
// Needs        OpenGL 3.3, current on the calling thread.
#pragma once

#include <SFML/Graphics/Image.hpp>

#include <functional>

namespace evod::viewer {

/// Calls `draw` with a framebuffer of this size bound, and returns the result as an opaque image. Afterwards binds the
/// previous framebuffer again. Throws std::runtime_error if the graphics driver does not support this size.
sf::Image draw_off_screen(unsigned width_pixels, unsigned height_pixels, const std::function<void()>& draw);

} // namespace evod::viewer
