// Seeks: simulate stored runs up to a moment, from the last stored state before that moment. They do so in short
// slices, so that other worlds continue meanwhile.
//
//   begin → wait until everything recorded is on the disk → read the file → simulate up to the moment → finish
//
// Owner        Replays, on the simulation thread.
// Full         above seeks_max seeks, a new one is refused. Seeks that wait for the disk are not counted.
// Determinism  a seek reproduces a run bit for bit. It does not change live worlds.
#pragma once

#include "server/replay/stored_run.h"
#include "server/runtime/run_reader.h"

#include <functional>
#include <map>
#include <optional>
#include <string>
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
    static constexpr std::size_t seeks_max = 64;

    struct Request {
        std::uint64_t session = 0; // number of the session; 0: the server
        std::string moves = {};    // the replay that the seek moves; empty: the seek opens a replay, or is for a fork
        bool opens = false;        // the seek opens a replay
        replay::StoredRun run;
        std::optional<replay::WantedMoment> to; // nullopt: the first moment of the run
        replay::RecordedUntil known;            // reached by the file if everything that was recorded is written
        replay::RecordedUntil shown = {};       // reached by the file in any case
        std::function<void(base::Result<SeekResult>)> done;
    };

    /// All arguments must outlive this object.
    Seeks(RunReader& reader, base::Executor& executor) : reader_{reader}, executor_{executor} {}

    /// Begins a seek once all records of the world are on the disk.
    void begin(const std::string& world, Request request);
    /// Ends all seeks of a session.
    void cancel_of_session(std::uint64_t session);
    /// Ends all seeks that move a replay, because the replay is closed.
    void cancel_of_replay(const std::string& replay);

    /// Returns the number of seeks that open a replay.
    ///
    /// session  counts only the seeks of this session; nullopt: all seeks.
    std::size_t opening_count(std::optional<std::uint64_t> session = {}) const;
    /// Whether a seek is simulating ticks now.
    bool under_way() const;
    /// Advances all seeks in turn by one tick each, until `stop` returns true or all have reached their moments.
    void advance(const std::function<bool()>& stop);
    /// Calls `done` of each seek that advance() has ended. May create worlds.
    void finish();

  private:
    struct Begun {
        Request request;
        bool started = false;                                // its file is being read, or was read
        std::optional<replay::SeekStart> running = {};       // set while it simulates
        std::optional<base::Result<SeekResult>> result = {}; // set when it has ended, until finish()
    };

    void read(std::uint64_t number, bool all_is_written);
    void run(std::uint64_t number, base::Result<replay::SeekStart> start);
    /// Ends a seek with this refusal.
    void refuse(std::uint64_t number, const base::Refusal& why);
    /// Removes and returns the seeks for which `is_wanted` returns true.
    std::vector<Begun> take(const std::function<bool(const Begun&)>& is_wanted);
    void cancel(const std::function<bool(const Begun&)>& is_wanted, const base::Refusal& why);

    RunReader& reader_;
    base::Executor& executor_;
    std::map<std::uint64_t, Begun> seeks_; // key: number of the seek
    std::uint64_t last_number_ = 0;
};

} // namespace evod::runtime
