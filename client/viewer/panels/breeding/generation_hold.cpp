#include "client/viewer/panels/breeding/generation_hold.h"

namespace evod::viewer {

void GenerationHold::set(bool on) {
    on_ = on;
    limited_ = false;
}

GenerationHold::Ask GenerationHold::update(const std::string& run, evod::v1::RunState state, bool stepping) {
    if (run != run_) {
        run_ = run;
        limited_ = false;
    }
    if (!on_) {
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
