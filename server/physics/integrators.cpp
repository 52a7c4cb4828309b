#include "server/physics/integrators.h"

#include "server/base/assert.h"
#include "server/base/elementary.h"

namespace evod::physics {

Integration integration(Integrator integrator, double tick_s, double damping_rate) {
    EVOD_ASSERT(tick_s > 0);
    EVOD_ASSERT(damping_rate >= 0);
    const double kept =
        integrator == Integrator::BackwardEuler ? 1 / (1 + damping_rate * tick_s) : base::exp(-damping_rate * tick_s);
    return {integrator, static_cast<float>(tick_s), static_cast<float>(kept)};
}

double damping_rate(double share_kept) {
    EVOD_ASSERT(share_kept > 0);
    EVOD_ASSERT(share_kept <= 1);
    return -base::log(share_kept) * 60;
}

} // namespace evod::physics
