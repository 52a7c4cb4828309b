// Body: writes and reads the numbers in the body of a snapshot, one after another, in the layout that stream.proto
// describes.
//
// The input of the writer must be valid. The reader checks everything.
//
// Threads      none; nothing here is shared.
#pragma once

#include "proto/codec/column.h"
#include "proto/codec/compression.h"
#include "proto/codec/little_endian.h"
#include "proto/codec/result.h"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace evod::codec {

class BodyWriter {
  public:
    template <std::unsigned_integral Number>
    void number(Number value) {
        store(value, grow(sizeof value));
    }

    /// Writes the values at `indices` in planes: the lowest byte of each number, then the next byte of each number, and
    /// so on. Bytes that rarely differ are then adjacent. Each number has `bytes` bytes, 1, 2 or 4.
    void planes(Numbers values, Numbers indices, std::uint32_t bytes);

    /// Writes signed numbers in the width that needs the fewest bytes.
    void column(Numbers values);

    /// Writes numbers in rising order.
    void rising_column(Numbers values);

    std::string take() { return std::move(body_); }
    /// Returns the offsets of all columns and planes. Must be called before take().
    Seams take_seams() { return std::move(seams_); }

  private:
    void seam() { seams_.push_back(static_cast<std::uint32_t>(body_.size())); }
    /// Writes whole numbers of sizeof(Number) bytes each.
    template <std::unsigned_integral Number>
    void plain(Numbers values);
    template <class Condition>
    void exceptions(Numbers values, std::uint64_t count, const Condition& is_exception);
    /// Like plain(), but writes 0 in place of each exception.
    template <std::unsigned_integral Number, class Condition>
    void fitting(Numbers values, const Condition& is_exception);
    char* grow(std::size_t bytes);

    std::string body_;
    Seams seams_;
};

/// Reads a body. After the first error, all numbers that it returns are 0 and all columns are empty.
class BodyReader {
  public:
    explicit BodyReader(std::string_view body) : rest_{body} {}

    const std::optional<Damage>& damage() const { return damage_; }
    std::size_t rest_bytes() const { return rest_.size(); }

    /// Records the error "a snapshot's body " + why, unless there already is one.
    void refuse(const std::string& why);

    template <std::unsigned_integral Number>
    Number number() {
        return take(sizeof(Number)) ? load<Number>(taken_) : Number{0};
    }

    Column planes(std::size_t count, std::uint32_t bytes);

    /// Reads a column. The caller must ensure that there is memory for `count` numbers.
    Column column(std::size_t count);

    /// Reads numbers in rising order, all of them below `end`.
    Column rising_column(std::size_t count, std::uint64_t end);

  private:
    bool take(std::size_t bytes);
    template <std::unsigned_integral Number, class Convert>
    Column numbers(std::size_t count, const Convert& convert);
    Column plain(std::size_t count);

    std::string_view rest_;
    const char* taken_ = nullptr;
    std::optional<Damage> damage_;
};

} // namespace evod::codec
