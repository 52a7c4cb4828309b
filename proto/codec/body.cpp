#include "proto/codec/body.h"

#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>

namespace evod::codec {
namespace {

constexpr std::uint8_t with_exceptions = 128; // flag in the width of a column
constexpr std::uint64_t exception_bytes = 8;

std::uint32_t widened(std::int32_t value) {
    return static_cast<std::uint32_t>(value);
}

} // namespace

char* BodyWriter::grow(std::size_t bytes) {
    body_.resize(body_.size() + bytes);
    return body_.data() + body_.size() - bytes;
}

template <std::unsigned_integral Number>
void BodyWriter::plain(Numbers values) {
    char* const to = grow(values.size() * sizeof(Number));
    for (std::size_t i = 0; i < values.size(); ++i) {
        store(static_cast<Number>(values[i]), to + i * sizeof(Number));
    }
}

void BodyWriter::planes(Numbers values, Numbers indices, std::uint32_t bytes) {
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
    bytes == 1   ? write(std::integral_constant<std::uint32_t, 1>{})
    : bytes == 2 ? write(std::integral_constant<std::uint32_t, 2>{})
                 : write(std::integral_constant<std::uint32_t, 4>{});
}

void BodyWriter::column(Numbers values) {
    // These count the numbers that need more than 0, 1 and 2 bytes.
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
        const auto too_large = [](std::uint32_t value) { return value + 0x80U > 0xffU; };
        exceptions(values, form.exceptions, too_large);
        fitting<std::uint8_t>(values, too_large);
    } else if (form.width == 2) {
        const auto too_large = [](std::uint32_t value) { return value + 0x8000U > 0xffffU; };
        exceptions(values, form.exceptions, too_large);
        fitting<std::uint16_t>(values, too_large);
    } else {
        plain<std::uint32_t>(values);
    }
}

void BodyWriter::rising_column(Numbers values) {
    Column steps(values.size());
    std::uint32_t before = std::numeric_limits<std::uint32_t>::max(); // -1
    for (std::size_t i = 0; i < values.size(); ++i) {
        steps[i] = values[i] - before - 1;
        before = values[i];
    }
    column(steps);
}

template <class Condition>
void BodyWriter::exceptions(Numbers values, std::uint64_t count, const Condition& is_exception) {
    if (count == 0) {
        return;
    }
    number(static_cast<std::uint32_t>(count));
    Column indices, exceptional;
    indices.reserve(count);
    exceptional.reserve(count);
    constexpr std::size_t block = 64; // most blocks contain no exception, which vector instructions detect quickly
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
void BodyWriter::fitting(Numbers values, const Condition& is_exception) {
    char* const to = grow(values.size() * sizeof(Number));
    for (std::size_t i = 0; i < values.size(); ++i) {
        store(is_exception(values[i]) ? Number{0} : static_cast<Number>(values[i]), to + i * sizeof(Number));
    }
}

void BodyReader::refuse(const std::string& why) {
    if (!damage_) {
        damage_ = Damage{"a snapshot's body " + why};
    }
}

bool BodyReader::take(std::size_t bytes) {
    if (damage_ || rest_.size() < bytes) {
        refuse("ends too early");
        return false;
    }
    taken_ = rest_.data();
    rest_.remove_prefix(bytes);
    return true;
}

template <std::unsigned_integral Number, class Convert>
Column BodyReader::numbers(std::size_t count, const Convert& convert) {
    if (!take(count * sizeof(Number))) {
        return {};
    }
    Column values(count);
    for (std::size_t i = 0; i < count; ++i) {
        values[i] = convert(load<Number>(taken_ + i * sizeof(Number)));
    }
    return values;
}

Column BodyReader::plain(std::size_t count) {
    return numbers<std::uint32_t>(count, [](std::uint32_t value) { return value; });
}

Column BodyReader::planes(std::size_t count, std::uint32_t bytes) {
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

Column BodyReader::column(std::size_t count) {
    const auto width = number<std::uint8_t>();
    Column indices, values;
    if (width & with_exceptions) {
        const auto exception_count = number<std::uint32_t>();
        indices = plain(exception_count);
        values = plain(exception_count);
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
        result = plain(count);
        break;
    default:
        refuse("has a column of " + std::to_string(width & ~with_exceptions) + " bytes per value, allowed 0, 1, 2, 4");
    }
    for (std::size_t i = 0; i < indices.size() && !damage_; ++i) {
        if (indices[i] >= count) {
            refuse("has a separately stored value for index " + std::to_string(indices[i]) + " of " +
                   std::to_string(count) + " values");
        } else {
            result[indices[i]] = values[i];
        }
    }
    return damage_ ? Column{} : result;
}

Column BodyReader::rising_column(std::size_t count, std::uint64_t end) {
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

} // namespace evod::codec
