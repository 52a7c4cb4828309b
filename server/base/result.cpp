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

namespace {

/// Replaces control characters except line breaks by '?', so that text from a file or an argument cannot control the
/// terminal that shows it.
std::string visible(std::string utf8) {
    for (std::size_t i = 0; i < utf8.size(); ++i) {
        const auto byte = static_cast<unsigned char>(utf8[i]);
        if ((byte < 0x20 && byte != '\n') || byte == 0x7f) {
            utf8[i] = '?';
        } else if (i > 0 && utf8[i - 1] == '\xc2' && byte >= 0x80 && byte < 0xa0) { // U+0080 to U+009F
            utf8.replace(--i, 2, "?");
        }
    }
    return utf8;
}

} // namespace

std::string to_text(const Violation& violation) {
    return visible(violation.field + ": " + text::violation_text(violation.got, violation.allowed));
}

std::string to_text(const Refusal& refusal) {
    std::string text = visible(refusal.message);
    for (const Violation& violation : refusal.violations) {
        text += "\n  " + to_text(violation);
    }
    return text;
}

void throw_exception_from_error(const Refusal& refusal, const boost::source_location&) {
    throw std::runtime_error{to_text(refusal)};
}

} // namespace evod::base
