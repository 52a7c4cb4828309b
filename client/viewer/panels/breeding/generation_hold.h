// GenerationHold: has a world stop after each generation, so that its breeding can be looked at.
//
// A generation that is over waits with its dead and its living; the next is bred with its first tick. So the world is
// told to run one generation, and then that tick.
//
// Threads      none.
#pragma once

#include "evod/v1/world.pb.h"

#include <optional>
#include <string>

namespace evod::viewer {

class GenerationHold {
  public:
    enum class Ask { Nothing, RunOneGeneration, RunOneTick };

    /// Who is held. A look at the past has the id of the run it shows, and another world's name.
    struct Run {
        std::string world, id;
        friend bool operator==(const Run&, const Run&) = default;
    };

    void hold(Run run);
    void let_go();
    bool on() const { return run_.has_value(); }

    /// What is to be asked of the world now. A run that is not the one that is held ends the hold: nobody meant it.
    ///
    /// state     as it is known
    /// stepping  it runs to a tick that somebody named, and stops there anyway
    Ask update(const Run& shown, evod::v1::RunState state, bool stepping);

  private:
    std::optional<Run> run_;
    bool limited_ = false; // the world was told to run one generation, and has not come to its end
};

} // namespace evod::viewer
