// Replays: handles the requests to open, move and close replays: worlds that show stored runs, beside the live worlds.
//
// Owner        the simulation loop, on the simulation thread.
// Determinism  a seek reproduces a run bit for bit. It only reads live worlds and does not change them.
#pragma once

#include "server/recording/recorder.h"
#include "server/runtime/replies.h"
#include "server/runtime/shown_replays.h"

#include <functional>
#include <string>
#include <utility>

namespace evod::runtime {

class Replays {
  public:
    static constexpr std::size_t replays_max = 4;         // maximum per client
    static constexpr std::size_t replays_of_all_max = 64; // maximum of all clients together

    /// All arguments must outlive this object.
    ///
    /// recorder  nullptr if the server stores no runs.
    /// reply     receives the replies.
    Replays(simulation::Laboratory& laboratory, Mailbox& mailbox, base::Executor& executor,
            recording::Recorder* recorder, std::function<void(Reply)> reply)
        : laboratory_{laboratory}
        , recorder_{recorder}
        , reply_{std::move(reply)}
        , reader_{mailbox, recorder}
        , seeks_{reader_, executor} {}

    void apply(const ReplayMail& mail);
    void find_run(const FindRun& mail);
    /// Closes all replays of a session that has ended, and cancels its seeks.
    void forget(std::uint64_t session);
    /// Seeks to the first moment of a generation in the run of a world, to fork it there. Seeks::finish() calls `done`.
    void seek_for_fork(const std::string& world, std::uint64_t generation,
                       std::function<void(base::Result<SeekResult>)> done);

    Seeks& seeks() { return seeks_; }
    const Seeks& seeks() const { return seeks_; }
    ShownReplays& shown() { return shown_; }
    /// Continues the request that waited for this receipt.
    void take(const recording::Receipt& receipt) { reader_.take(receipt); }

  private:
    void open(const OpenReplay& request, const ReplayMail& mail);
    void seek(const Seek& request, const ReplayMail& mail);
    base::Result<std::string> close(const CloseReplay& request);
    /// Answers a request with the replay that now shows the requested moment, or with a refusal.
    ///
    /// world  the name of the replay, or the refusal.
    void answer(const ReplayMail& mail, const base::Result<std::string>& world);
    /// Returns the stored run of a world; refused if there is none.
    base::Result<replay::StoredRun> run_of(const std::string& world) const;
    /// Returns the present moment of the world if it is live and has this run; otherwise zeros.
    replay::RecordedUntil recorded_until(const std::string& world, const simulation::RunId& run_id) const;

    simulation::Laboratory& laboratory_;
    recording::Recorder* recorder_;
    const std::function<void(Reply)> reply_;
    std::uint64_t last_name_ = 0;
    RunReader reader_;
    Seeks seeks_;
    ShownReplays shown_{laboratory_, reader_};
};

} // namespace evod::runtime
