// Off the screen: drawing into a picture, which a covered or small window cannot spoil.
//
// Needs        OpenGL 3.3, current on the calling thread.
#pragma once

#include <SFML/Graphics/Image.hpp>

#include <functional>

namespace evod::viewer {

/// What `draw` draws on a framebuffer of this size, opaque. The framebuffer before is current again afterwards. Throws
/// std::runtime_error if a picture of this size cannot be drawn.
sf::Image draw_off_screen(unsigned width_pixels, unsigned height_pixels, const std::function<void()>& draw);

} // namespace evod::viewer
