#include "client/viewer/shell/frame_writer.h"

#include "client/viewer/drawing/png.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <vector>

extern char** environ;

namespace evod::viewer {

namespace {

namespace fs = std::filesystem;

bool is_frame(const std::string& name) {
    return name.starts_with("frame-") && (name.ends_with(".png") || name.ends_with(".png.part"));
}

/// Writes single frames. They get the folder's name when all are there.
class FolderWriter final : public FrameWriter {
  public:
    explicit FolderWriter(const std::string& path)
        : path_{fs::path{path}.has_filename() ? fs::path{path} : fs::path{path}.parent_path()}
        , part_{path_.string() + ".part"} {
        for (const std::string& name : names_in(path_)) {
            if (is_frame(name)) {
                throw std::runtime_error{path + " contains frames of an earlier recording, such as " + name +
                                         ": choose another folder"};
            }
        }
        for (const std::string& name : names_in(part_)) {
            if (!is_frame(name)) {
                throw std::runtime_error{part_.string() + " exists, and is not an unfinished recording: move it away"};
            }
        }
        std::error_code error;
        fs::remove_all(part_, error);
        if (!error) {
            fs::create_directories(part_, error);
        }
        if (error) {
            throw std::runtime_error{"could not create the folder " + part_.string() + ": " + error.message()};
        }
    }
    ~FolderWriter() override {
        std::error_code ignored; // finish() has moved all that is wanted
        fs::remove_all(part_, ignored);
    }
    FolderWriter(const FolderWriter&) = delete;
    FolderWriter& operator=(const FolderWriter&) = delete;

    void add(const sf::Image& frame, std::uint64_t tick) override {
        write_file((part_ / frame_file_name(frame_count_, tick)).string(), png_of(frame));
        ++frame_count_;
    }

    void finish() override {
        std::error_code error;
        if (!fs::exists(path_, error)) {
            fs::rename(part_, path_, error);
        } else {
            for (const std::string& name : names_in(part_)) {
                fs::rename(part_ / name, path_ / name, error);
                if (error) {
                    break;
                }
            }
        }
        if (error) {
            throw std::runtime_error{"could not write " + path_.string() + ": " + error.message()};
        }
    }

  private:
    /// The names of the files in a folder; none if it does not exist.
    static std::vector<std::string> names_in(const fs::path& folder) {
        std::error_code error;
        std::vector<std::string> names;
        if (fs::exists(folder, error) && !error) {
            for (const auto& entry : fs::directory_iterator{folder, error}) {
                names.push_back(entry.path().filename().string());
            }
        }
        if (error) {
            throw std::runtime_error{"could not read the folder " + folder.string() + ": " + error.message()};
        }
        return names;
    }

    fs::path path_, part_;
};

/// Writes a film: sends raw frames through a pipe to ffmpeg. The film gets its name when it is complete.
class FilmWriter final : public FrameWriter {
  public:
    FilmWriter(std::string path, unsigned width_pixels, unsigned height_pixels, double fps)
        : path_{std::move(path)}, output_{std::tmpfile()} {
        std::error_code error_of_link;
        if (const fs::path target = fs::canonical(path_, error_of_link); !error_of_link) {
            path_ = target.string(); // renaming would replace a link
        }
        // ffmpeg chooses the format by the ending.
        const fs::path whole{path_};
        part_ = (whole.parent_path() / (whole.stem().string() + ".part" + whole.extension().string())).string();
        std::array<int, 2> ends{-1, -1};
        if (output_ == nullptr || pipe2(ends.data(), O_CLOEXEC) != 0) {
            throw std::runtime_error{std::string{"could not start ffmpeg: "} + std::strerror(errno)};
        }
        std::signal(SIGPIPE, SIG_IGN); // if ffmpeg ends early, writing fails instead of ending evoview
        std::vector<std::string> words{
            "ffmpeg",    "-y",
            "-loglevel", "error",
            "-f",        "rawvideo",
            "-pix_fmt",  "rgba",
            "-s",        std::to_string(width_pixels) + "x" + std::to_string(height_pixels),
            "-r",        std::to_string(fps),
            "-i",        "-",
            "-vf",       "pad=ceil(iw/2)*2:ceil(ih/2)*2"}; // codecs require an even width and height
        if (!path_.ends_with(".gif")) {
            words.insert(words.end(), {"-pix_fmt", "yuv420p"}); // every player supports this pixel format
        }
        words.push_back("file:" + part_);
        std::vector<char*> arguments;
        for (std::string& word : words) {
            arguments.push_back(word.data());
        }
        arguments.push_back(nullptr);
        posix_spawn_file_actions_t actions;
        posix_spawnattr_t attributes;
        posix_spawn_file_actions_init(&actions);
        posix_spawnattr_init(&attributes);
        posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
        posix_spawn_file_actions_adddup2(&actions, fileno(output_.get()), STDOUT_FILENO);
        posix_spawn_file_actions_adddup2(&actions, fileno(output_.get()), STDERR_FILENO);
        // ffmpeg gets its own process group. Ctrl+C in a terminal then interrupts only evoview, which completes the
        // film.
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
        const int error = posix_spawnp(&process_, "ffmpeg", &actions, &attributes, arguments.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        posix_spawnattr_destroy(&attributes);
        close(ends[0]);
        pipe_ = ends[1];
        if (error != 0) {
            process_ = 0;
            stop();
            throw std::runtime_error{"could not start ffmpeg to create " + path_ + " (" + std::strerror(error) +
                                     "): install ffmpeg, or choose a folder for single frames"};
        }
    }
    ~FilmWriter() override {
        stop();
        ::unlink(part_.c_str()); // finish() has renamed a complete film
    }
    FilmWriter(const FilmWriter&) = delete;
    FilmWriter& operator=(const FilmWriter&) = delete;

    void add(const sf::Image& frame, std::uint64_t) override {
        const std::uint8_t* pixels = frame.getPixelsPtr();
        std::size_t left = std::size_t{4} * frame.getSize().x * frame.getSize().y;
        while (left > 0) {
            const ssize_t written = ::write(pipe_, pixels, left);
            if (written < 0 && errno == EINTR) {
                continue;
            }
            if (written < 0) {
                finish(); // throws, with the message that ffmpeg printed
                throw std::runtime_error{"could not write " + path_ + ": ffmpeg exited before the film was complete"};
            }
            pixels += written;
            left -= static_cast<std::size_t>(written);
        }
        ++frame_count_;
    }

    void finish() override {
        const int status = stop();
        if (status == 0) {
            if (std::rename(part_.c_str(), path_.c_str()) != 0) {
                throw std::runtime_error{"could not write " + path_ + ": " + std::strerror(errno)};
            }
            return;
        }
        std::string output(2000, '\0');
        std::rewind(output_.get());
        output.resize(std::fread(output.data(), 1, output.size(), output_.get()));
        output.erase(std::find_if(output.rbegin(), output.rend(), [](char c) { return c != '\n'; }).base(),
                     output.end());
        throw std::runtime_error{"could not write " + path_ + ": ffmpeg " +
                                 (WIFSIGNALED(status) ? "was ended by signal " + std::to_string(WTERMSIG(status))
                                                      : "ended with status " + std::to_string(WEXITSTATUS(status))) +
                                 (output.empty() ? "" : ": " + output)};
    }

  private:
    /// Closes the pipe, waits for ffmpeg to end and returns its wait status. Returns 0 if ffmpeg was stopped before.
    int stop() {
        if (pipe_ >= 0) {
            close(pipe_);
            pipe_ = -1;
        }
        int status = 0;
        if (process_ > 0) {
            while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
            }
            process_ = 0;
        }
        return status;
    }

    std::string path_, part_; // the names of the complete and of the unfinished film
    struct Close {
        void operator()(FILE* file) const { std::fclose(file); }
    };
    std::unique_ptr<FILE, Close> output_; // receives the standard output and error of ffmpeg
    int pipe_ = -1;
    pid_t process_ = 0;
};

} // namespace

std::string frame_file_name(std::size_t number, std::uint64_t tick) {
    std::string digits = std::to_string(number);
    digits.insert(0, digits.size() < 6 ? 6 - digits.size() : 0, '0');
    return "frame-" + digits + "-tick-" + std::to_string(tick) + ".png";
}

bool is_film(const std::string& path) {
    static constexpr const char* endings[] = {".mp4", ".mkv", ".webm", ".mov", ".avi", ".gif"};
    return std::ranges::any_of(endings, [&](const char* ending) { return path.ends_with(ending); });
}

std::unique_ptr<FrameWriter> open_frame_writer(const std::string& path, unsigned width_pixels, unsigned height_pixels,
                                               double fps) {
    if (is_film(path)) {
        return std::make_unique<FilmWriter>(path, width_pixels, height_pixels, fps);
    }
    return std::make_unique<FolderWriter>(path);
}

} // namespace evod::viewer
