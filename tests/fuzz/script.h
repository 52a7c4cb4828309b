// A script: bytes taken as numbers, and as the fields of messages. When they are used up they go on as zeros, which
// leave fields out, so that every script ends.
#pragma once

#include <google/protobuf/message.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

namespace evod::fuzz {

class Script {
  public:
    explicit Script(std::span<const std::uint8_t> bytes) : bytes_{bytes} {}

    bool over() const { return bytes_.empty(); }

    template <class T = std::uint8_t>
    T take() {
        T value{};
        const std::string taken = take_bytes(sizeof value);
        std::memcpy(&value, taken.data(), taken.size());
        return value;
    }
    /// Fewer at the end.
    std::string take_bytes(std::size_t count) {
        const auto taken = bytes_.first(std::min(count, bytes_.size()));
        bytes_ = bytes_.subspan(taken.size());
        return {reinterpret_cast<const char*>(taken.data()), taken.size()};
    }
    template <class T, std::size_t count>
    const T& one_of(const T (&choices)[count]) {
        return choices[take() % count];
    }
    /// `likely` three times of four.
    bool rarely() { return take() % 4 == 3; }

  private:
    std::span<const std::uint8_t> bytes_;
};

/// Gives a message's fields values that are often those of something that is there, and now and then extreme ones. Of a
/// oneof, at most one field.
void fill(google::protobuf::Message& message, Script& script);

} // namespace evod::fuzz
