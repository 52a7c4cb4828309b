// Seeks: simulate stored runs up to a moment, from the last stored state before that moment. The loop of the replays
// decides when each of them advances.
//
//   begin → read the file → simulate up to the moment → take_ended
//
// Owner        the loop of the replays, on its thread. Background jobs read the files.
// Full         the places of replays (network/replay_places.h) bound the number of seeks: of the seeks that move a
//              replay, one is read and one simulates.
// Determinism  a seek reproduces a run bit for bit.
#pragma once

#include "server/runtime/file_jobs.h"
#include "server/runtime/mailbox.h"

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace evod::runtime {

/// The result of a successful seek.
struct SeekResult {
    replay::Rerun rerun;
    simulation::Replay there;
};

/// A replay of a run file. It exists as long as the server runs.
struct FileReplay {
    std::string name;
    replay::StoredRun run;
    SeekResult shown;

    /// Opens a run file and seeks to the first moment of the run, or of the given generation.
    static base::Result<FileReplay> open(const std::string& path, std::optional<std::uint64_t> generation,
                                         base::Executor& executor);
};

class Seeks {
  public:
    /// What a seek is for: to open a replay, to move one, or to bring a world for a fork.
    struct Purpose {
        std::variant<ReplayMail, CommandMail> request; // a command is a fork
        std::string replay = {};                       // the replay that the seek moves; empty: the seek moves none

        bool opens_replay() const;
        std::uint64_t session() const; // 0: the seek does not end with a session
        std::string user() const;      // whose account pays for its time
    };
    struct Request {
        Purpose purpose;
        replay::StoredRun run;
        std::optional<replay::WantedMoment> to; // nullopt: the first moment of the run
        replay::RecordedUntil until;            // the file reaches this moment
    };
    /// A seek that has reached its moment, or failed, or was cancelled.
    struct Ended {
        Request request;
        base::Result<SeekResult> result;
    };
    /// A seek that simulates.
    struct Running {
        Request request;
        std::string user = {};
        std::optional<replay::SeekStart> at = {};                      // empty while the file is being read
        std::uint64_t turn = 0;                                        // when it last had a slice; the loop sets it
        std::stop_source reading = std::stop_source{std::nostopstate}; // cancels the job that reads the file
    };

    /// All arguments must outlive this object. mailbox: of the loop, which gets the results of jobs.
    Seeks(Mailbox& mailbox, FileJobs& jobs, base::Executor& executor)
        : mailbox_{mailbox}, jobs_{jobs}, executor_{executor} {}

    void begin(Request request);
    /// Handles the result of a job: the seek begins to simulate. Returns the session to which it belongs; 0: to none.
    std::uint64_t take(const SeekRead& mail);
    /// Ends the seek that opens a replay for this request, if there is one.
    void cancel_opening(std::uint64_t session, std::uint64_t request_id, const base::Refusal& why);
    /// Ends all seeks of a session.
    void cancel_of_session(std::uint64_t session);
    /// Ends all seeks that move a replay, because the replay is closed.
    void cancel_of_replay(const std::string& replay);

    /// All seeks, by number. Those whose file is being read cannot advance.
    std::map<std::uint64_t, Running>& all() { return seeks_; }
    bool under_way() const;
    /// Memory of the seeks of a session that simulate.
    std::size_t held_bytes(std::uint64_t session) const;
    /// Advances a seek until `stop` returns true or it has ended, at least by one tick.
    void advance(std::uint64_t seek, const std::function<bool()>& stop);
    /// Returns and removes the seeks that have ended, in the order in which they ended.
    std::vector<Ended> take_ended() { return std::exchange(ended_, {}); }

  private:
    void end(std::map<std::uint64_t, Running>::iterator seek, base::Result<SeekResult> result);
    void cancel(const std::function<bool(const Running&)>& is_wanted, const base::Refusal& why);

    Mailbox& mailbox_;
    FileJobs& jobs_;
    base::Executor& executor_;
    std::map<std::uint64_t, Running> seeks_; // key: number of the seek
    std::vector<Ended> ended_;
    std::uint64_t last_number_ = 0;
};

} // namespace evod::runtime
