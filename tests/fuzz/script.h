// A script: bytes read as numbers and as message fields. After its end it continues with zeros, which mean absent
// fields, so every script ends.
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
    /// Fewer near the end.
    std::string take_bytes(std::size_t count) {
        const auto taken = bytes_.first(std::min(count, bytes_.size()));
        bytes_ = bytes_.subspan(taken.size());
        return {reinterpret_cast<const char*>(taken.data()), taken.size()};
    }
    template <class T, std::size_t count>
    const T& one_of(const T (&choices)[count]) {
        return choices[take() % count];
    }
    /// `likely` in three of four cases.
    bool rarely() { return take() % 4 == 3; }

  private:
    std::span<const std::uint8_t> bytes_;
};

/// Fills the fields of a message, often with values of existing things and sometimes with extreme ones. Sets at most
/// one field of a oneof.
void fill(google::protobuf::Message& message, Script& script);

} // namespace evod::fuzz
