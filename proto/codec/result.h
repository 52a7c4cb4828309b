// Result<T>: either a value, or the reason why bytes could not be decoded.
#pragma once

#include <boost/system/result.hpp>

#include <string>

namespace evod::codec {

/// The limit that the bytes exceed, if any.
enum class ExceededLimit { Nothing, FrameBytes, MessageDepth };

/// Describes invalid bytes. `what` is one sentence without a full stop, for logs and users.
struct Damage {
    std::string what;
    ExceededLimit exceeded = ExceededLimit::Nothing;
    friend bool operator==(const Damage&, const Damage&) = default;
};

[[noreturn]] void throw_exception_from_error(const Damage& damage, const boost::source_location& where);

template <class T>
using Result = boost::system::result<T, Damage>;

} // namespace evod::codec
