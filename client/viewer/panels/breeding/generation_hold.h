// GenerationHold: pauses a world after each generation, so that the user can inspect how the next one was bred.
//
// A world that has finished a generation waits before it breeds. The first tick of the next generation performs the
// breeding. GenerationHold therefore sends two commands: run one generation, then step one tick.
//
// Owner        BreedingPanel.
// Threads      none.
#pragma once

#include "evod/v1/world.pb.h"

#include <optional>
#include <string>

namespace evod::viewer {

class GenerationHold {
  public:
    enum class Action { None, RunOneGeneration, RunOneTick };

    /// Identifies the held run. A replay has the same run id as the run that it shows, but its own world name.
    struct Run {
        std::string world, id;
        friend bool operator==(const Run&, const Run&) = default;
    };

    void hold(Run run);
    void release();
    bool on() const { return run_.has_value(); }

    /// Returns the command to send to the world now. Ends the hold if another run is shown.
    ///
    /// state     the run state that the server reported last
    /// stepping  whether the world runs to a given tick and pauses there
    Action update(const Run& shown, evod::v1::RunState state, bool stepping);

  private:
    std::optional<Run> run_;
    bool limited_ = false; // whether the world runs the requested generation
};

} // namespace evod::viewer
