// Draws: the random decisions of one history. The same seed gives the same decisions on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>

namespace evod::histories {

class Draws {
  public:
    explicit Draws(std::uint64_t seed) : engine_{seed} {}

    /// A number from 0 to limit - 1; limit >= 1.
    std::uint64_t below(std::uint64_t limit) { return engine_() % limit; }
    std::uint32_t count(std::uint32_t min, std::uint32_t max) {
        return min + static_cast<std::uint32_t>(below(std::uint64_t{max} - min + 1));
    }
    double number(double min, double max) {
        return min + (max - min) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
    }
    bool chance(double share) { return number(0, 1) < share; }
    template <class Values>
    const auto& one_of(const Values& values) {
        return *std::next(std::begin(values), static_cast<std::ptrdiff_t>(below(std::size(values))));
    }

  private:
    std::mt19937_64 engine_;
};

} // namespace evod::histories
