// Result<T>: a value, or what is wrong with the bytes that should have given one.
#pragma once

#include <boost/system/result.hpp>

#include <string>

namespace evod::codec {

/// A limit that bytes went beyond.
enum class Beyond { Nothing, FrameBytes, MessageDepth };

/// Bytes that are not what they should be. `what` is one sentence without a full stop, fit for a log or a person.
struct Damage {
    std::string what;
    Beyond beyond = Beyond::Nothing;
    friend bool operator==(const Damage&, const Damage&) = default;
};

[[noreturn]] void throw_exception_from_error(const Damage& damage, const boost::source_location& where);

template <class T>
using Result = boost::system::result<T, Damage>;

} // namespace evod::codec
