// Bodies: the numbers of a picture's body, as stream.proto lays them out, one after another.
//
// The writer is handed numbers that are right; the reader trusts nothing.
//
// Threads      none; nothing here is shared.
#pragma once

#include "proto/codec/column.h"
#include "proto/codec/compression.h"
#include "proto/codec/little_endian.h"
#include "proto/codec/result.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace evod::codec {

constexpr std::uint8_t with_exceptions = 128; // in a column's width
constexpr std::uint64_t exception_bytes = 8;

class BodyWriter {
  public:
    BodyWriter() = default;
    /// bytes  that it will hold.
    explicit BodyWriter(std::size_t bytes) { body_.reserve(bytes); }

    template <std::unsigned_integral Number>
    void number(Number value) {
        store(value, grow(sizeof value));
    }

    /// Whole numbers of sizeof(Number) bytes.
    template <std::unsigned_integral Number>
    void plain(Numbers values) {
        char* const to = grow(values.size() * sizeof(Number));
        for (std::size_t i = 0; i < values.size(); ++i) {
            store(static_cast<Number>(values[i]), to + i * sizeof(Number));
        }
    }

    /// Of those at `indices` the lowest byte of each, then the next of each: those that are all but the same stand
    /// together. bytes: 2 or 4.
    void planes(Numbers values, Numbers indices, std::uint32_t bytes) {
        const std::size_t begin = body_.size(), count = indices.size();
        for (std::uint32_t plane = 0; plane < bytes; ++plane) {
            seam();
            grow(count);
        }
        const auto write = [&](auto constant_bytes) {
            char* const to = body_.data() + begin;
            for (std::size_t i = 0; i < count; ++i) {
                const std::uint32_t value = values[indices[i]];
                for (std::uint32_t plane = 0; plane < constant_bytes; ++plane) {
                    to[plane * count + i] = static_cast<char>(value >> (8 * plane));
                }
            }
        };
        bytes == 2 ? write(std::integral_constant<std::uint32_t, 2>{})
                   : write(std::integral_constant<std::uint32_t, 4>{});
    }

    /// Signed numbers, in the width that takes the fewest bytes.
    void column(Numbers values) {
        // How many need more than 0, 1, 2 bytes.
        std::uint32_t not_zero = 0, above_8_bits = 0, above_16_bits = 0;
        for (const std::uint32_t value : values) {
            not_zero += value != 0;
            above_8_bits += value + 0x80U > 0xffU;
            above_16_bits += value + 0x8000U > 0xffffU;
        }
        struct Form {
            std::uint64_t width, exceptions;
            std::uint64_t bytes(std::uint64_t count) const {
                return count * width + (exceptions > 0 ? 4 + exceptions * exception_bytes : 0);
            }
        };
        const std::array<Form, 4> forms{{{0, not_zero}, {1, above_8_bits}, {2, above_16_bits}, {4, 0}}};
        const Form form = *std::min_element(forms.begin(), forms.end(), [&](const Form& a, const Form& b) {
            return a.bytes(values.size()) < b.bytes(values.size());
        });
        seam();
        number(static_cast<std::uint8_t>(form.width | (form.exceptions > 0 ? with_exceptions : 0)));
        if (form.width == 0) {
            exceptions(values, form.exceptions, [](std::uint32_t value) { return value != 0; });
        } else if (form.width == 1) {
            const auto fits_not = [](std::uint32_t value) { return value + 0x80U > 0xffU; };
            exceptions(values, form.exceptions, fits_not);
            fitting<std::uint8_t>(values, fits_not);
        } else if (form.width == 2) {
            const auto fits_not = [](std::uint32_t value) { return value + 0x8000U > 0xffffU; };
            exceptions(values, form.exceptions, fits_not);
            fitting<std::uint16_t>(values, fits_not);
        } else {
            plain<std::uint32_t>(values);
        }
    }

    void rising_column(Numbers values) {
        Column steps(values.size());
        std::uint32_t before = std::numeric_limits<std::uint32_t>::max(); // -1
        for (std::size_t i = 0; i < values.size(); ++i) {
            steps[i] = values[i] - before - 1;
            before = values[i];
        }
        column(steps);
    }

    std::string take() { return std::move(body_); }
    /// Before every column and plane; to be taken first.
    Seams take_seams() { return std::move(seams_); }

  private:
    void seam() { seams_.push_back(static_cast<std::uint32_t>(body_.size())); }
    template <class Condition>
    void exceptions(Numbers values, std::uint64_t count, const Condition& is_exception) {
        if (count == 0) {
            return;
        }
        number(static_cast<std::uint32_t>(count));
        Column indices, exceptional;
        indices.reserve(count);
        exceptional.reserve(count);
        constexpr std::size_t block = 64; // of which mostly none is
        for (std::size_t begin = 0; begin < values.size(); begin += block) {
            const Numbers some = values.subspan(begin, std::min(block, values.size() - begin));
            unsigned any = 0;
            for (const std::uint32_t value : some) {
                any |= unsigned{is_exception(value)};
            }
            for (std::size_t i = 0; any && i < some.size(); ++i) {
                if (is_exception(some[i])) {
                    indices.push_back(static_cast<std::uint32_t>(begin + i));
                    exceptional.push_back(some[i]);
                }
            }
        }
        plain<std::uint32_t>(indices);
        plain<std::uint32_t>(exceptional);
    }
    template <std::unsigned_integral Number, class Condition>
    void fitting(Numbers values, const Condition& is_exception) {
        char* const to = grow(values.size() * sizeof(Number));
        for (std::size_t i = 0; i < values.size(); ++i) {
            store(is_exception(values[i]) ? Number{0} : static_cast<Number>(values[i]), to + i * sizeof(Number));
        }
    }
    char* grow(std::size_t bytes) {
        body_.resize(body_.size() + bytes);
        return body_.data() + body_.size() - bytes;
    }

    std::string body_;
    Seams seams_;
};

/// Reads what a body should hold. After the first thing that is wrong everything is empty or 0.
class BodyReader {
  public:
    explicit BodyReader(std::string_view body) : rest_{body} {}

    const std::optional<Damage>& damage() const { return damage_; }
    std::size_t rest_bytes() const { return rest_.size(); }

    void refuse(const std::string& why) {
        if (!damage_) {
            damage_ = Damage{"a snapshot's body " + why};
        }
    }

    template <std::unsigned_integral Number>
    Number number() {
        return take(sizeof(Number)) ? load<Number>(taken_) : Number{0};
    }

    template <std::unsigned_integral Number>
    Column plain(std::size_t count) {
        return numbers<Number>(count, [](Number value) { return std::uint32_t{value}; });
    }

    Column positions(std::size_t count, std::uint32_t position_bytes) {
        return position_bytes == 2 ? plain<std::uint16_t>(count) : plain<std::uint32_t>(count);
    }

    Column planes(std::size_t count, std::uint32_t bytes) {
        if (!take(count * bytes)) {
            return {};
        }
        Column values(count, 0);
        for (std::uint32_t plane = 0; plane < bytes; ++plane) {
            const char* const from = taken_ + plane * count;
            for (std::size_t i = 0; i < count; ++i) {
                values[i] |= std::uint32_t{static_cast<unsigned char>(from[i])} << (8 * plane);
            }
        }
        return values;
    }

    /// The caller sees to it that there is memory for `count` numbers.
    Column column(std::size_t count) {
        const auto width = number<std::uint8_t>();
        Column indices, values;
        if (width & with_exceptions) {
            const auto exception_count = number<std::uint32_t>();
            indices = plain<std::uint32_t>(exception_count);
            values = plain<std::uint32_t>(exception_count);
        }
        Column result;
        switch (width & ~with_exceptions) {
        case 0:
            result.assign(damage_ ? 0 : count, 0);
            break;
        case 1:
            result = numbers<std::uint8_t>(count, [](std::uint8_t value) { return widened(std::int8_t(value)); });
            break;
        case 2:
            result = numbers<std::uint16_t>(count, [](std::uint16_t value) { return widened(std::int16_t(value)); });
            break;
        case 4:
            result = plain<std::uint32_t>(count);
            break;
        default:
            refuse("has a column of width " + std::to_string(width & ~with_exceptions) + ", not 0, 1, 2 or 4");
        }
        for (std::size_t i = 0; i < indices.size() && !damage_; ++i) {
            if (indices[i] >= count) {
                refuse("has an exception for number " + std::to_string(indices[i]) + " of " + std::to_string(count));
            } else {
                result[indices[i]] = values[i];
            }
        }
        return damage_ ? Column{} : result;
    }

    /// Numbers below `end`.
    Column rising_column(std::size_t count, std::uint64_t end) {
        Column steps = column(count);
        std::uint64_t next = 0;
        for (std::uint32_t& value : steps) {
            next += value;
            if (next >= end) {
                refuse("has an id or index that is too large");
                return {};
            }
            value = static_cast<std::uint32_t>(next++);
        }
        return steps;
    }

  private:
    static std::uint32_t widened(std::int32_t value) { return static_cast<std::uint32_t>(value); }

    bool take(std::size_t bytes) {
        if (damage_ || rest_.size() < bytes) {
            refuse("ends too early");
            return false;
        }
        taken_ = rest_.data();
        rest_.remove_prefix(bytes);
        return true;
    }
    template <std::unsigned_integral Number, class Convert>
    Column numbers(std::size_t count, const Convert& convert) {
        if (!take(count * sizeof(Number))) {
            return {};
        }
        Column values(count);
        for (std::size_t i = 0; i < count; ++i) {
            values[i] = convert(load<Number>(taken_ + i * sizeof(Number)));
        }
        return values;
    }

    std::string_view rest_;
    const char* taken_ = nullptr;
    std::optional<Damage> damage_;
};

} // namespace evod::codec
