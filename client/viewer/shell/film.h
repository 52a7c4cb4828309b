// Film: where recorded pictures go: a folder with a file for each, or ffmpeg, which makes a film of them.
//
// Owner        record().
// Threads      none; ffmpeg is a process of its own, which is ended with the Film.
#pragma once

#include <SFML/Graphics/Image.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace evod::viewer {

class Film {
  public:
    virtual ~Film() = default;

    // All of these throw std::runtime_error, with path and reason.
    virtual void add(const sf::Image& picture, std::uint64_t tick) = 0;
    /// All that was added is in its place after it.
    virtual void finish() = 0;

    std::size_t picture_count() const { return picture_count_; }

  protected:
    std::size_t picture_count_ = 0;
};

/// "frame-000012-tick-720.png": number from 0, so that names stand in the order of time.
std::string picture_name(std::size_t number, std::uint64_t tick);

/// Whether a path names a film for ffmpeg, by its ending (.mp4, .mkv, .webm, .mov, .avi, .gif); else it is a folder.
bool is_film(const std::string& path);

/// A film is made in the place of one that is there; a folder is made unless it is there, and must have no such
/// pictures.
///
/// fps  pictures a second of a film
std::unique_ptr<Film> begin_film(const std::string& path, unsigned width_pixels, unsigned height_pixels, double fps);

} // namespace evod::viewer
