#include "client/viewer/panels/breeding/generation_hold.h"

#include <utility>

namespace evod::viewer {

void GenerationHold::hold(Run run) {
    run_ = std::move(run);
    limited_ = false;
}

void GenerationHold::release() {
    run_.reset();
    limited_ = false;
}

GenerationHold::Action GenerationHold::update(const Run& shown, evod::v1::RunState state, bool stepping) {
    if (run_ != shown) {
        release();
        return Action::None;
    }
    if (state == evod::v1::RUN_STATE_RUNNING && !stepping && !limited_) {
        limited_ = true;
        return Action::RunOneGeneration;
    }
    if (state == evod::v1::RUN_STATE_WAITING && limited_) {
        limited_ = false;
        return Action::RunOneTick;
    }
    return Action::None;
}

} // namespace evod::viewer
