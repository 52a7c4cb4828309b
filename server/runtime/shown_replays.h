// Shown replays: the worlds that show stored runs.
//
// Owner        the loop of the replays, on its thread. Background jobs read the files.
// Determinism  a running replay applies the stored changes at their ticks. If the run is live, the replay continues
//              with the records that were added since.
#pragma once

#include "server/runtime/seeks.h"

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::runtime {

class ShownReplays {
  public:
    static constexpr std::chrono::milliseconds refresh_time{250};

    /// All arguments must outlive this object. mailbox: of the loop, which gets the results of jobs.
    ShownReplays(simulation::Laboratory& laboratory, Mailbox& mailbox, FileJobs& jobs)
        : laboratory_{laboratory}, mailbox_{mailbox}, jobs_{jobs} {}

    struct Owner {
        std::uint64_t session = 0; // number of the session; 0: the server
        std::string user = {};     // whose account pays for the time of the replay
    };
    /// Creates the world of a replay.
    void show(const std::string& name, const replay::StoredRun& run, Owner owner, SeekResult result);
    /// Makes a replay show another moment of its run.
    void move_to(const std::string& name, SeekResult result);
    void close(const std::string& name);

    /// The stored run of a replay; nullptr: there is no such replay.
    const replay::StoredRun* run_of(const std::string& name) const;
    /// The owner of a replay; nullptr: there is no such replay.
    const Owner* owner_of(std::string_view name) const;
    /// The replays of a session; nullopt: all replays.
    std::vector<std::string> names(std::optional<std::uint64_t> session = {}) const;

    /// Memory of the replays of a session.
    std::size_t held_bytes(std::uint64_t session) const;

    /// Must be called after every tick of a replay.
    void follow(simulation::Entry& entry);
    /// Reads new records for each running replay that has reached the end of its known records.
    ///
    /// returns  the time of the next call; nullopt: no call is needed.
    std::optional<Clock::time_point> refresh(Clock::time_point now);
    /// Handles the result of a job.
    void take(const RecordsRead& mail);

  private:
    struct Shown {
        replay::StoredRun run;
        replay::ComingChanges changes;
        std::uint64_t entries_read = 0; // number of journal entries that were read into `changes`
        Owner owner;
        Clock::time_point refreshed = {};
        bool being_read = false; // its new records are being read
    };

    simulation::Entry& entry_of(const std::string& name);
    void extend(simulation::Entry& entry, Shown& shown, const replay::NewRecords& records);

    simulation::Laboratory& laboratory_;
    Mailbox& mailbox_;
    FileJobs& jobs_;
    std::map<std::string, Shown, std::less<>> replays_; // key: name of the replay
};

} // namespace evod::runtime
