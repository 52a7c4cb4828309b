#include "client/viewer/panels/breeding/generation_hold.h"

#include <utility>

namespace evod::viewer {

void GenerationHold::hold(Run run) {
    run_ = std::move(run);
    limited_ = false;
}

void GenerationHold::let_go() {
    run_.reset();
    limited_ = false;
}

GenerationHold::Ask GenerationHold::update(const Run& shown, evod::v1::RunState state, bool stepping) {
    if (run_ != shown) {
        let_go();
        return Ask::Nothing;
    }
    if (state == evod::v1::RUN_STATE_RUNNING && !stepping && !limited_) {
        limited_ = true;
        return Ask::RunOneGeneration;
    }
    if (state == evod::v1::RUN_STATE_WAITING && limited_) {
        limited_ = false;
        return Ask::RunOneTick;
    }
    return Ask::Nothing;
}

} // namespace evod::viewer
