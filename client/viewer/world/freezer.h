// Freezer: a folder with populations and single organisms, which the user keeps to place them in worlds later.
//
// Each is a file NAME.csv in the format of proto/codec/population_csv.h, the same as `evod export --what population`
// writes. A file with one row is a single organism. Files that other programs add, change or remove are noticed.
//
// Owner        Panels.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/core/client_types.h"
#include "proto/codec/population_csv.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace evod::viewer {

/// A file of the freezer.
struct Frozen {
    std::string name;             // of the file, without ".csv"
    codec::Population population; // without islands if the file is unusable
    std::string problem;          // why the file is unusable, as a sentence; empty: it is usable

    std::size_t organism_count() const;
    bool is_organism() const { return organism_count() == 1; }
    /// Returns what the file contains: "1 organism", "50 organisms", "400 organisms on 8 islands".
    std::string content_text() const;
};

class Freezer {
  public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::uintmax_t file_bytes_max = 16 << 20; // about 200,000 organisms
    static constexpr std::size_t files_max = 1000;             // further files are not listed

    /// folder  created when the first file is saved; empty: nothing can be stored.
    explicit Freezer(std::filesystem::path folder = {}) : folder_{std::move(folder)} {}

    const std::filesystem::path& folder() const { return folder_; }

    /// Looks for changed files, at most once a second, and reads them. Call it once per frame while files are shown.
    void update(Clock::time_point now);
    /// Returns the files, in the order of their names.
    const std::vector<Frozen>& files() const { return files_; }
    /// Returns the file with this name; null if there is none.
    const Frozen* find(std::string_view name) const;
    /// Returns why the folder cannot be read, as a sentence; empty if it can or does not exist yet.
    const std::string& problem() const { return problem_; }

    /// Stores genes in a new file, and returns its name: `name`, or a name with a number if it exists (unused_name()).
    core::Result<std::string> save(const std::string& name, const codec::Population& population);
    /// Deletes a file. Returns why this failed, as a sentence; empty on success.
    std::string remove(const std::string& name);

  private:
    struct Seen { // the state of a file when it was read
        std::filesystem::file_time_type changed;
        std::uintmax_t bytes = 0;
        friend bool operator==(const Seen&, const Seen&) = default;
    };
    void read();
    std::filesystem::path path_of(const std::string& name) const { return folder_ / (name + ".csv"); }

    std::filesystem::path folder_;
    std::vector<Frozen> files_;
    std::map<std::string, Seen> seen_; // by name
    std::string problem_;
    Clock::time_point next_{};
};

/// Returns the default folder: $XDG_DATA_HOME/evod/freezer or ~/.local/share/evod/freezer; empty if neither
/// XDG_DATA_HOME nor HOME is set.
std::filesystem::path default_freezer_folder();

} // namespace evod::viewer
