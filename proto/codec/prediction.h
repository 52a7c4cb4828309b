// Prediction: where the delta codec expects an entity, at constant velocity.
//
// Determinism  all arithmetic uses integers.
#pragma once

#include "proto/codec/column.h"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace evod::codec {

/// Predicts, at constant velocity, how far an entity moves in `ticks` ticks if it moved by `displacement` in base_ticks
/// ticks.
class Prediction {
  public:
    Prediction(std::uint16_t ticks, std::uint16_t base_ticks)
        : ticks_{ticks}, base_ticks_{std::max<std::uint16_t>(base_ticks, 1)} {}

    std::uint32_t operator()(std::uint32_t displacement) const {
        if (ticks_ == base_ticks_) {
            return displacement;
        }
        const std::int64_t product = std::int64_t{static_cast<std::int32_t>(displacement)} * ticks_;
        const std::int64_t rounded_down = product / base_ticks_ - (product % base_ticks_ < 0 ? 1 : 0);
        return static_cast<std::uint32_t>(rounded_down);
    }

    /// Computes the residuals of entities at the positions `here` that were at the positions `there`. All columns have
    /// the same length.
    void residuals(Numbers here, Numbers there, Numbers displacements, std::uint32_t* to) const {
        if (ticks_ == base_ticks_) { // the usual case; the compiler uses vector instructions
            for (std::size_t i = 0; i < here.size(); ++i) {
                to[i] = here[i] - there[i] - displacements[i];
            }
            return;
        }
        unsigned all_small = 1;
        for (const std::uint32_t displacement : displacements) {
            all_small &= unsigned{displacement + small_ <= 2 * small_};
        }
        if (all_small) { // common at full speed, where intervals vary; the compiler uses vector instructions here, too
            const Prediction predicted = *this; // a local copy, so that the compiler knows that `to` does not alias it
            for (std::size_t i = 0; i < here.size(); ++i) {
                to[i] = here[i] - there[i] - predicted.predict_small(displacements[i]);
            }
            return;
        }
        for (std::size_t i = 0; i < here.size(); ++i) {
            to[i] = here[i] - there[i] - (*this)(displacements[i]);
        }
    }

  private:
    /// Predicts a displacement of at most small_ in either direction with a multiplication instead of a division. The
    /// quotient is exact for numbers below 2^31 (Granlund and Montgomery, Division by Invariant Integers using
    /// Multiplication, 1994, theorem 4.2).
    std::uint32_t predict_small(std::uint32_t displacement) const {
        const std::uint32_t product = displacement * ticks_ + ahead_ * base_ticks_; // never negative
        return static_cast<std::uint32_t>(std::uint64_t{product} * reciprocal_ >> shift_) - ahead_;
    }

    static constexpr std::uint32_t product_max = 1U << 29; // maximum product of a small displacement and ticks
    std::uint32_t ticks_, base_ticks_;
    std::uint32_t small_ = product_max / std::max(ticks_, 1U);
    std::uint32_t ahead_ = product_max / base_ticks_ + 1;
    // The shift is 31 + log2 of base_ticks_, rounded up.
    unsigned shift_ = 31 + static_cast<unsigned>(std::bit_width(base_ticks_ - 1));
    std::uint32_t reciprocal_ = static_cast<std::uint32_t>((std::uint64_t{1} << shift_) / base_ticks_ + 1);
};

} // namespace evod::codec
