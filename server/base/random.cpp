#include "server/base/random.h"

#include "server/base/elementary.h"

#include <Random123/philox.h>

#include <cmath>

namespace evod::base {
namespace {

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::uint32_t key_low,
                                    std::uint32_t key_high) {
    const auto out = r123::Philox4x32{}({{counter[0], counter[1], counter[2], counter[3]}}, {{key_low, key_high}});
    return {out[0], out[1], out[2], out[3]};
}

std::uint32_t low_half(std::uint64_t value) {
    return static_cast<std::uint32_t>(value);
}
std::uint32_t high_half(std::uint64_t value) {
    return static_cast<std::uint32_t>(value >> 32);
}

} // namespace

RandomKey::RandomKey(Seed seed, Purpose purpose, std::uint32_t island, std::uint64_t generation) {
    const auto words =
        philox({static_cast<std::uint32_t>(purpose), island, low_half(generation), high_half(generation)},
               low_half(seed.value), high_half(seed.value));
    low_ = words[0];
    high_ = words[1];
}

std::array<std::uint32_t, 4> RandomKey::words(std::uint32_t entity, std::uint64_t tick, std::uint32_t block) const {
    return philox({entity, block, low_half(tick), high_half(tick)}, low_, high_);
}

std::array<std::uint32_t, 2> RandomKey::pair(std::uint32_t entity, std::uint32_t tick) const {
    const auto out = r123::Philox2x32{}({{entity, pair_counter(tick)}}, {{pair_key()}});
    return {out[0], out[1]};
}

double RandomStream::gaussian() {
    const double radius = std::sqrt(-2 * log(1 - uniform())); // 1 − [0, 1) is never 0
    return radius * cos_turns(uniform());
}

} // namespace evod::base
