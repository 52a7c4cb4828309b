// GenerationHold: has a world stop after each generation, so that its breeding can be looked at.
//
// A generation that is over waits with its dead and its living; the next is bred with its first tick. So the world is
// told to run one generation, and then that tick.
//
// Threads      none.
#pragma once

#include "evod/v1/world.pb.h"

#include <string>

namespace evod::viewer {

class GenerationHold {
  public:
    enum class Ask { Nothing, RunOneGeneration, RunOneTick };

    void set(bool on);
    bool on() const { return on_; }

    /// What is to be asked of the world now.
    ///
    /// run       its id: what was told to a run before says nothing of this one
    /// state     as it is known
    /// stepping  it runs to a tick that somebody named, and stops there anyway
    Ask update(const std::string& run, evod::v1::RunState state, bool stepping);

  private:
    bool on_ = false;
    std::string run_;
    bool limited_ = false; // the world was told to run one generation, and has not come to its end
};

} // namespace evod::viewer
