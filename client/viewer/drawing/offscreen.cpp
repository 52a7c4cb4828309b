#define GL_GLEXT_PROTOTYPES
#include "client/viewer/drawing/offscreen.h"

#include <GL/gl.h>
#include <GL/glext.h>

#include <cstdint>
#include <stdexcept>
#include <vector>

namespace evod::viewer {

sf::Image draw_off_screen(unsigned width_pixels, unsigned height_pixels, const std::function<void()>& draw) {
    const auto width = static_cast<int>(width_pixels), height = static_cast<int>(height_pixels);
    int before = 0;
    glGetIntegerv(GL_FRAMEBUFFER_BINDING, &before);
    unsigned framebuffer = 0, colours = 0;
    glGenFramebuffers(1, &framebuffer);
    glGenRenderbuffers(1, &colours);
    glBindRenderbuffer(GL_RENDERBUFFER, colours);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colours);
    const bool complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;

    std::vector<std::uint8_t> pixels(std::size_t{4} * width_pixels * height_pixels);
    if (complete) {
        draw();
        glPixelStorei(GL_PACK_ALIGNMENT, 1);
        glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    }
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<unsigned>(before));
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteRenderbuffers(1, &colours);
    if (!complete) {
        throw std::runtime_error{"the graphics driver cannot draw an image of this size"};
    }
    for (std::size_t alpha = 3; alpha < pixels.size(); alpha += 4) {
        pixels[alpha] = 255;
    }
    sf::Image image;
    image.create(width_pixels, height_pixels, pixels.data());
    image.flipVertically();
    return image;
}

} // namespace evod::viewer
