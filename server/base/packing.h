// Packing: numbers as bytes, for processes that run the same program on the same kind of machine (exchange.h).
#pragma once

#include "server/base/assert.h"

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace evod::base {

class Packer {
  public:
    template <class T>
    requires std::is_trivially_copyable_v<T>
    void add(const T& value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof value); }

    /// Appends the values, without their number.
    template <class T>
    requires std::is_trivially_copyable_v<T>
    void add_values(std::span<const T> values) {
        bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
    }
    /// Appends the number of values, then the values, which lie side by side in memory: std::vector, base::Column,
    /// std::string.
    template <class Values>
    void add_list(const Values& values) {
        add(std::uint64_t{values.size()});
        add_values(std::span<const typename Values::value_type>{values});
    }

    /// Appends what another packer has written.
    void append(Packer other) { bytes_ += other.bytes_; }

    std::string take() { return std::move(bytes_); }

  private:
    std::string bytes_;
};

/// Reads what a Packer has written, in the same order. Does not own the bytes.
class Unpacker {
  public:
    explicit Unpacker(std::string_view bytes) : rest_{bytes} {}

    template <class T>
    requires std::is_trivially_copyable_v<T> T next() {
        T value;
        next_values(std::span{&value, 1});
        return value;
    }
    template <class T>
    requires std::is_trivially_copyable_v<T>
    void next_values(std::span<T> values) {
        EVOD_ASSERT(values.size_bytes() <= rest_.size());
        if (!values.empty()) {
            std::memcpy(values.data(), rest_.data(), values.size_bytes());
        }
        rest_.remove_prefix(values.size_bytes());
    }
    template <class T>
    std::vector<T> next_list() {
        std::vector<T> values;
        next_list(values);
        return values;
    }
    /// Replaces the contents of `values`.
    template <class Values>
    void next_list(Values& values) {
        using T = typename Values::value_type;
        const auto count = next<std::uint64_t>();
        EVOD_ASSERT(count <= rest_.size() / sizeof(T));
        values.resize(count);
        next_values(std::span<T>{values});
    }
    std::string next_text() {
        std::string text;
        next_list(text);
        return text;
    }
    bool empty() const { return rest_.empty(); }

  private:
    std::string_view rest_;
};

} // namespace evod::base
