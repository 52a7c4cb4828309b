// Result<T>: a value, or a Refusal that names every wrong field. Used wherever input from outside is checked and
// converted.
#pragma once

#include "proto/text/violation_text.h"

#include <boost/system/result.hpp>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace evod::base {

/// Why a request was refused. The numbers are those of google.rpc.Code.
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

/// The reason for a refusal, in a form that programs can test. The numbers are those of evod.v1.Reason.
enum class Reason {
    Unspecified = 0,
    FieldInvalid = 10,
    FieldUnknown = 11,
    RequestUnknown = 12,
    MessageUnreadable = 13,
    RequestIdReused = 14,
    RequestTooOld = 15,
    RoleTooLow = 16,
    RequestsInFlightMax = 17,
    ServerBusy = 18,
    ServerGoingAway = 19,
    StorageFailing = 20,
    AnswerTooLarge = 21,
    WorldNotFound = 30,
    WorldExists = 31,
    WorldsMax = 32,
    WorldIsReplay = 33,
    WorldIsLive = 34,
    RunEnded = 35,
    NothingToResume = 36,
    NoLease = 37,
    RevisionChanged = 38,
    PlannedChangesMax = 39,
    PlannedChangeNotFound = 40,
    ResetImpossible = 41,
    IslandNotFound = 42,
    OrganismNotFound = 43,
    GenerationOver = 44,
    GenerationChanged = 45,
    NoBodies = 46,
    PlacedMax = 47,
    WorldFrozen = 60,
    OwnerWorldsMax = 61,
    FitnessNotAwaited = 48,
    WorldDamaged = 49,
    RunsNotKept = 50,
    MomentNotFound = 51,
    SeekSuperseded = 52,
    ReplaysMax = 53,
    ExportsMax = 54,
    ExportNotFound = 55,
    ExportEnded = 56,
    NotBredYet = 57,
    ModelVersionDiffers = 58,
    RunFileDamaged = 59,
    SubscriptionNotFound = 70,
    SubscriptionsMax = 71,
    NoView = 72,
    FrameInvalid = 80,
    FrameLate = 81,
    ProtocolVersion = 82,
    HelloMissing = 83,
    HelloRepeated = 84,
    TlsRequired = 85,
    TokenMissing = 86,
    TokenUnknown = 87,
    TokenRevoked = 88,
    LoginTooSoon = 89,
    AuthenticationUnavailable = 90,
    SessionsMax = 91,
    ClassNotFound = 100,
    ClassExists = 101,
    MemberNotFound = 102,
    MembersMax = 103,
    ClassesMax = 104,
    CodeUnknown = 105,
    MemberNameTaken = 106,
    MemberRemoved = 107,
    JoinsTooFast = 108,
};

/// Returns the name of the code as users see it, for example "INVALID_ARGUMENT".
const char* name_of(RefusalCode code);

/// A wrong field of a request, with the values that it allows.
struct Violation {
    std::string field;   // as the sender spells it: "parameters.mutation_chance"
    std::string allowed; // "0 to 1"
    std::string got;     // "1.5"
};

/// What Violation::got contains if `field` is a name that does not exist.
using text::unknown_name;

/// A value in the message of a refusal, for programs. evod.v1.Argument lists the names.
struct Argument {
    std::string name, value;
};

/// The error that is returned for a refused request. A refused request has changed nothing.
struct Refusal {
    RefusalCode code = RefusalCode::InvalidArgument;
    std::string message; // one sentence
    std::vector<Violation> violations;
    Reason reason = Reason::Unspecified;
    std::vector<Argument> arguments = {};
};

/// Creates a refusal that names no field.
inline Refusal refusal(RefusalCode code, std::string message, Reason reason = Reason::Unspecified,
                       std::vector<Argument> arguments = {}) {
    return {.code = code,
            .message = std::move(message),
            .violations = {},
            .reason = reason,
            .arguments = std::move(arguments)};
}

/// Creates the refusal of a request that exceeds a limit.
///
/// limit    name in the table of limits: "worlds_max".
/// held     number that the client, its user or all clients hold already.
inline Refusal limit_refusal(std::string message, Reason reason, std::string limit, std::size_t held,
                             std::size_t allowed) {
    return refusal(RefusalCode::ResourceExhausted, std::move(message), reason,
                   {{"limit", std::move(limit)}, {"held", std::to_string(held)}, {"allowed", std::to_string(allowed)}});
}

/// Returns the refusal as text: the message, then one line per violation.
std::string to_text(const Refusal& refusal);

/// Returns the violation as one line: "field: got X, allowed Y".
std::string to_text(const Violation& violation);

[[noreturn]] void throw_exception_from_error(const Refusal& refusal, const boost::source_location& where);

template <class T>
using Result = boost::system::result<T, Refusal>;

} // namespace evod::base
