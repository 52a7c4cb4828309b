// GenerationHold: stops a world after each generation, so that the user can inspect how the next one was bred.
//
// A world that has finished a generation waits before it breeds; the first tick of the next generation breeds it. The
// hold therefore sends two commands: run one generation, then step one tick.
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

    /// The held run. A replay has the id of the run that it shows and a world name of its own.
    struct Run {
        std::string world, id;
        friend bool operator==(const Run&, const Run&) = default;
    };

    void hold(Run run);
    void release();
    bool on() const { return run_.has_value(); }

    /// Returns the command to send to the world now. The hold ends when another run is shown.
    ///
    /// state     the last that the server reported
    /// stepping  the world runs to a given tick and stops there by itself
    Action update(const Run& shown, evod::v1::RunState state, bool stepping);

  private:
    std::optional<Run> run_;
    bool limited_ = false; // the world runs one generation and has not finished it
};

} // namespace evod::viewer
