#include "server/base/result.h"

#include <stdexcept>

namespace evod::base {

const char* name_of(RefusalCode code) {
    switch (code) {
    case RefusalCode::InvalidArgument:
        return "INVALID_ARGUMENT";
    case RefusalCode::NotFound:
        return "NOT_FOUND";
    case RefusalCode::AlreadyExists:
        return "ALREADY_EXISTS";
    case RefusalCode::PermissionDenied:
        return "PERMISSION_DENIED";
    case RefusalCode::ResourceExhausted:
        return "RESOURCE_EXHAUSTED";
    case RefusalCode::FailedPrecondition:
        return "FAILED_PRECONDITION";
    case RefusalCode::Aborted:
        return "ABORTED";
    case RefusalCode::Unimplemented:
        return "UNIMPLEMENTED";
    case RefusalCode::Unavailable:
        return "UNAVAILABLE";
    case RefusalCode::DataLoss:
        return "DATA_LOSS";
    case RefusalCode::Unauthenticated:
        return "UNAUTHENTICATED";
    }
    return "UNKNOWN";
}

std::string to_text(const Violation& violation) {
    return violation.field + ": got " + violation.got + ", allowed " + violation.allowed;
}

std::string to_text(const Refusal& refusal) {
    std::string text = refusal.message;
    for (const Violation& violation : refusal.violations)
        text += "\n  " + to_text(violation);
    return text;
}

void throw_exception_from_error(const Refusal& refusal, const boost::source_location&) {
    throw std::runtime_error{to_text(refusal)};
}

} // namespace evod::base
