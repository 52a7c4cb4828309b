// FrameWriter: writes the frames of a recording, either as PNG files into a folder or as a film with ffmpeg.
//
// Owner        record().
// Threads      none; ffmpeg is a separate process, which ends with the FrameWriter.
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

    // Writes a frame. add() and finish() throw std::runtime_error with the path and the reason.
    virtual void add(const sf::Image& frame, std::uint64_t tick) = 0;
    /// Completes the output. Afterwards the folder or film contains every added frame.
    virtual void finish() = 0;

    std::size_t frame_count() const { return frame_count_; }

  protected:
    std::size_t frame_count_ = 0;
};

/// Returns the file name of a frame: "frame-000012-tick-720.png". The number counts from 0 and has leading zeros, so
/// that names sort by time.
std::string frame_file_name(std::size_t number, std::uint64_t tick);

/// Returns whether a path names a film, that is, ends in .mp4, .mkv, .webm, .mov, .avi or .gif. Any other path names a
/// folder.
bool is_film(const std::string& path);

/// Creates a writer for a film or a folder. Replaces an existing film. Creates the folder if it does not exist, and
/// rejects a folder that contains frames of another recording. Throws std::runtime_error with the path and the reason.
///
/// fps  frames per second of the film
std::unique_ptr<FrameWriter> open_frame_writer(const std::string& path, unsigned width_pixels, unsigned height_pixels,
                                               double fps);

} // namespace evod::viewer
