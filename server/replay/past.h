// Past: what the file of a run tells, for those who look back: which moments there are, and from where each can be
// simulated again.
//
// The file is opened for each look, and found under the name of an ended run too, so a run may go on, be reset or be
// thinned meanwhile.
//
// Threads      none of its own; asked by any, each with a copy of its own.
#pragma once

#include "server/replay/rerun.h"
#include "server/simulation/laboratory.h"

#include <optional>
#include <string>
#include <vector>

namespace evod::replay {

/// A moment as somebody asks for it. With neither: the last that is known.
struct WantedMoment {
    std::optional<std::uint64_t> generation;
    std::optional<std::uint64_t> tick; // of the generation; of the run where no generation is given
};

/// A moment that there is. A generation's last tick is its end; the next one's beginning is another moment.
struct PastMoment {
    std::uint64_t generation = 1;
    std::uint64_t tick = 0; // since the run began
};

/// The way to a moment.
struct Departure {
    simulation::Replay there; // what there is to be seen; replay_of is left empty
    PastMoment to;
    Rerun from; // the last moment up to that one that is known without simulating
};

/// Until where a run that goes on has been handed over to be written. What its file contains by then reaches as far, or
/// further; zeros: nothing is known but what the file contains.
struct KnownUntil {
    std::uint64_t generation = 0, tick = 0;
};

/// What a run that goes on has come to.
struct PastNews {
    simulation::Replay there;                      // replay_of is left empty
    std::string path;                              // of its file
    std::uint64_t after_entry = 0, last_entry = 0; // of the journal, between which the changes were looked for
    std::vector<ParameterChange> changes;
};

class Past {
  public:
    /// Of how many generations before it a world of the past knows the statistics, at most.
    static constexpr std::size_t history_generations_known = 1'000;

    /// paths  where the run's file is, or may come to be.
    Past(std::vector<std::string> paths, const simulation::RunId& run_id) : paths_{std::move(paths)}, run_id_{run_id} {}
    /// The run of a file, whichever it is. Refused where there is none, or it cannot be simulated again.
    static base::Result<Past> of_file(const std::string& path);

    const simulation::RunId& run_id() const { return run_id_; }
    /// The name of the world whose run it is, as the file says.
    base::Result<std::string> world_name() const;

    /// Refused, saying what there is, unless that moment has been.
    ///
    /// wanted  nothing: the first.
    /// known   taken before the caller began to wait for the disk, so that the file contains every command until then and
    ///         the beginning of that generation. Taken later, it would reach beyond what the file contains.
    base::Result<Departure> depart(const std::optional<WantedMoment>& wanted, KnownUntil known,
                                   base::Executor& executor) const;

    /// after_entry  the journal's entries up to this one are known, and are not read again.
    base::Result<PastNews> news(std::uint64_t after_entry) const;

    /// Its file, wherever it is now, to be read.
    base::Result<std::unique_ptr<run_file::RunFile>> open() const;

  private:
    std::vector<std::string> paths_;
    simulation::RunId run_id_;
};

} // namespace evod::replay
