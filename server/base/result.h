// Result<T>: a value, or a Refusal that says what was wrong with every field. Used where outside input is translated.
#pragma once

#include <boost/system/result.hpp>

#include <string>
#include <utility>
#include <vector>

namespace evod::base {

/// Why a request was refused; the numbers are those of google.rpc.Code.
enum class RefusalCode {
    InvalidArgument = 3,
    NotFound = 5,
    AlreadyExists = 6,
    PermissionDenied = 7,
    ResourceExhausted = 8,
    FailedPrecondition = 9,
    Aborted = 10,
    Unimplemented = 12,
    Unavailable = 14,
    DataLoss = 15,
    Unauthenticated = 16,
};

/// The code as users read it: "INVALID_ARGUMENT".
const char* name_of(RefusalCode code);

/// One field that is wrong.
struct Violation {
    std::string field;   // as the sender spells it: "parameters.mutation_chance"
    std::string allowed; // "0 to 1"
    std::string got;     // "1.5"
};

/// A typed "no": nothing has changed.
struct Refusal {
    RefusalCode code = RefusalCode::InvalidArgument;
    std::string message; // one sentence
    std::vector<Violation> violations;
};

/// A refusal that is not about a field.
inline Refusal refusal(RefusalCode code, std::string message) {
    return {.code = code, .message = std::move(message), .violations = {}};
}

/// The refusal as one text: the message, then a line per violation.
std::string to_text(const Refusal& refusal);

/// "field: got X, allowed Y", one violation on one line.
std::string to_text(const Violation& violation);

[[noreturn]] void throw_exception_from_error(const Refusal& refusal, const boost::source_location& where);

template <class T>
using Result = boost::system::result<T, Refusal>;

} // namespace evod::base
