// Steps: the unit of lengths, health and headings in snapshots. One step is 1/16 px, 1/16 of health, or 1/256 of a full
// turn.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace evod::codec {

constexpr unsigned steps_per_px_log2 = 4;
constexpr float steps_per_px = 1 << steps_per_px_log2;

/// Converts steps to px, or to health. The result is exact below 2^24 steps. Steps are at most 2^31 - 1; processors
/// convert signed numbers faster.
inline float px_of(std::uint32_t steps) {
    return static_cast<float>(static_cast<std::int32_t>(steps)) * (1 / steps_per_px);
}

/// Converts px or health to steps. The result is rounded to the nearest step and limited to the range.
///
/// px  must be finite.
inline std::uint32_t steps_of(float px) {
    constexpr double most = std::numeric_limits<std::int32_t>::max();
    return static_cast<std::uint32_t>(std::clamp(double{px} * steps_per_px + 0.5, 0.0, most));
}

/// Returns the number of bytes that a position needs on an island of this size: 2 or 4.
inline std::uint32_t position_bytes_of(double width_px, double height_px) {
    return std::max(width_px, height_px) * steps_per_px <= 65535.0 ? 2 : 4;
}

/// Converts fixed-point positions to steps. The result is rounded to the nearest step, halves upward, and limited to
/// the range of position_bytes.
class PositionInSteps {
  public:
    /// fraction_bits  4 to 30; the unit of positions is 2^-fraction_bits px.
    PositionInSteps(unsigned fraction_bits, std::uint32_t position_bytes)
        : shift_{fraction_bits - steps_per_px_log2}
        , half_{shift_ == 0 ? 0 : std::int32_t{1} << (shift_ - 1)}
        , largest_{std::numeric_limits<std::int32_t>::max() - half_} // the largest position that can be rounded up
        , top_{position_bytes == 2 ? std::int32_t{0xffff} : std::numeric_limits<std::int32_t>::max()} {}

    std::uint32_t operator()(std::int32_t position) const {
        return static_cast<std::uint32_t>(
            std::clamp((std::min(position, largest_) + half_) >> shift_, std::int32_t{0}, top_));
    }

  private:
    unsigned shift_;
    std::int32_t half_, largest_, top_;
};

/// The number of steps of a heading in a full turn. A heading needs one byte.
constexpr unsigned heading_steps = 256;

/// Converts radians, which must be finite, to the nearest step of a heading, 0 to 255.
inline std::uint32_t heading_in_steps(float radians) {
    constexpr double per_radian = heading_steps / 6.283185307179586;
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(double{radians} * per_radian + 0.5))) %
           heading_steps;
}

/// Converts steps of a heading to radians, −π to π − 1 step.
inline float radians_of(std::uint32_t steps) {
    constexpr double per_step = 6.283185307179586 / heading_steps;
    return static_cast<float>(static_cast<double>(static_cast<std::int8_t>(steps)) * per_step);
}

inline std::uint16_t size_in_steps(float size) {
    // If `steps` is NaN, the first comparison is false, so the result is 0.
    const float steps = size * steps_per_px + 0.5F;
    const float not_negative = steps > 0.F ? steps : 0.F;
    return static_cast<std::uint16_t>(static_cast<std::int32_t>(not_negative < 65535.F ? not_negative : 65535.F));
}

} // namespace evod::codec
