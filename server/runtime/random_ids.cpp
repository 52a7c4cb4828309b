#include "server/runtime/random_ids.h"

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
    return {draw()};
}

simulation::RunId draw_run_id() {
    const std::uint64_t high = draw();
    return {high, draw()};
}

} // namespace evod::runtime
