// Shown replays: the worlds in the laboratory that show stored runs, beside the live worlds.
//
// Owner        Replays, on the simulation thread.
// Determinism  a running replay applies the stored changes at their ticks. If the run is live, the replay continues
//              with the records that were added since.
#pragma once

#include "server/runtime/seeks.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace evod::runtime {

class ShownReplays {
  public:
    static constexpr std::chrono::milliseconds refresh_time{250};

    /// All arguments must outlive this object.
    ShownReplays(simulation::Laboratory& laboratory, RunReader& reader) : laboratory_{laboratory}, reader_{reader} {}

    /// Creates the world of a replay.
    ///
    /// owner  number of the session; 0: the server.
    void show(const std::string& name, const replay::StoredRun& run, std::uint64_t owner, SeekResult result);
    /// Makes a replay show another moment of its run.
    void move_to(const std::string& name, SeekResult result);
    void close(const std::string& name);

    /// The stored run of a replay; nullptr: there is no such replay.
    const replay::StoredRun* run_of(const std::string& name) const;
    /// Whether a session has opened the replay.
    bool is_owned(const std::string& name) const;
    /// The replays of a session; nullopt: all replays.
    std::vector<std::string> names(std::optional<std::uint64_t> owner = {}) const;

    /// Must be called after every tick of a replay.
    void follow(simulation::Entry& entry);
    /// Reads new records for each running replay that has reached the end of its known records.
    ///
    /// returns  the time of the next call; nullopt: no call is needed.
    std::optional<Clock::time_point> refresh(Clock::time_point now);
    /// Returns the replays that a seek has moved since the last call.
    std::vector<std::string> take_moved_replays() { return std::exchange(moved_, {}); }

  private:
    struct Shown {
        replay::StoredRun run;
        replay::ComingChanges changes;
        std::uint64_t entries_read = 0; // number of journal entries that were read into `changes`
        std::uint64_t owner = 0;
        Clock::time_point refreshed;
        bool being_read = false; // its new records are being read
    };

    simulation::Entry& entry_of(const std::string& name);
    void read_new_records(const std::string& name, Shown& shown);
    void extend(simulation::Entry& entry, Shown& shown, const replay::NewRecords& records);

    simulation::Laboratory& laboratory_;
    RunReader& reader_;
    std::map<std::string, Shown, std::less<>> replays_; // key: name of the replay
    std::vector<std::string> moved_;
};

} // namespace evod::runtime
