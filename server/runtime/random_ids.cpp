#include "server/runtime/random_ids.h"

#include "server/base/exact_number.h"

#include <random>

namespace evod::runtime {
namespace {

std::uint64_t draw() {
    static thread_local std::random_device device;
    const std::uint64_t high = device();
    return high << 32 | device();
}

} // namespace

base::Seed draw_seed() {
    return base::portable_seed(draw());
}

simulation::RunId draw_run_id() {
    const std::uint64_t high = draw();
    return {high, draw()};
}

} // namespace evod::runtime
