// FrameWriter: writes the frames of a recording, to a folder with one PNG file each, or to a film by ffmpeg.
//
// Owner        record().
// Threads      none; ffmpeg is a process, which ends with the FrameWriter.
#pragma once

#include <SFML/Graphics/Image.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace evod::viewer {

class FrameWriter {
  public:
    virtual ~FrameWriter() = default;

    // Both throw std::runtime_error, with path and reason.
    virtual void add(const sf::Image& frame, std::uint64_t tick) = 0;
    /// Completes the output. Afterwards every added frame is in the folder or film.
    virtual void finish() = 0;

    std::size_t frame_count() const { return frame_count_; }

  protected:
    std::size_t frame_count_ = 0;
};

/// "frame-000012-tick-720.png": with a number from 0, so that the names sort by time.
std::string frame_file_name(std::size_t number, std::uint64_t tick);

/// Whether a path names a film, by its ending (.mp4, .mkv, .webm, .mov, .avi, .gif); else it names a folder.
bool is_film(const std::string& path);

/// Replaces a film that exists. Makes the folder unless it exists; a folder with frames of another recording is refused.
/// Throws std::runtime_error, with path and reason.
///
/// fps  frames per second of a film
std::unique_ptr<FrameWriter> open_frame_writer(const std::string& path, unsigned width_pixels, unsigned height_pixels,
                                               double fps);

} // namespace evod::viewer
