#include "server/protocol/refusals.h"

#include "server/protocol/public_text.h"

#include <algorithm>

namespace evod::protocol {
namespace {

// Maximum number of violations in an answer. Without a limit, a hostile request could cause an answer of several
// megabytes.
constexpr std::size_t violations_listed_max = 200;

/// Returns the reason of a refusal, or the default reason of its code.
base::Reason reason_of(const base::Refusal& refusal) {
    if (refusal.reason != base::Reason::Unspecified) {
        return refusal.reason;
    }
    switch (refusal.code) {
    case base::RefusalCode::InvalidArgument:
        return base::Reason::FieldInvalid;
    case base::RefusalCode::PermissionDenied:
        return base::Reason::RoleTooLow;
    case base::RefusalCode::Unavailable:
        return base::Reason::StorageFailing;
    case base::RefusalCode::DataLoss:
        return base::Reason::RunFileDamaged;
    default:
        return base::Reason::Unspecified;
    }
}

} // namespace

v1::Status to_proto(const base::Refusal& refusal) {
    v1::Status status;
    status.set_code(static_cast<v1::Code>(refusal.code));
    status.set_reason(static_cast<v1::Reason>(reason_of(refusal)));
    status.set_message(quotable(public_text(refusal.message), 2000));
    for (const base::Violation& violation : refusal.violations) {
        if (static_cast<std::size_t>(status.violations_size()) == violations_listed_max) {
            status.mutable_message()->append(" (" + std::to_string(refusal.violations.size()) +
                                             " fields are invalid; the first " + std::to_string(violations_listed_max) +
                                             " are listed)");
            break;
        }
        v1::Violation& listed = *status.add_violations();
        listed.set_field(quotable(violation.field, 200));
        listed.set_allowed(quotable(violation.allowed, 2000));
        listed.set_got(violation.got.empty() ? "nothing" : quotable(violation.got, 200));
    }
    return status;
}

v1::Response refusing(std::uint64_t request_id, const base::Refusal& refusal) {
    v1::Response response;
    response.set_request_id(request_id);
    *response.mutable_status() = to_proto(refusal);
    return response;
}

namespace {

/// If the first character of `text` controls a terminal, ends a line or changes the direction of text, returns its
/// length in bytes; otherwise 0.
std::size_t unsafe_character_bytes(std::string_view text) {
    const auto byte = [&](std::size_t at) { return at < text.size() ? static_cast<unsigned char>(text[at]) : 0; };
    const auto is = [](int value, int least, int most) { return value >= least && value <= most; };
    if (byte(0) < 0x20 || byte(0) == 0x7f) {
        return 1;
    }
    if ((byte(0) == 0xc2 && is(byte(1), 0x80, 0x9f)) || (byte(0) == 0xd8 && byte(1) == 0x9c)) { // U+0080 to 9F, U+061C
        return 2;
    }
    const bool e280 = byte(0) == 0xe2 && byte(1) == 0x80, e281 = byte(0) == 0xe2 && byte(1) == 0x81;
    if ((e280 && (is(byte(2), 0x8e, 0x8f) || is(byte(2), 0xa8, 0xae))) || // U+200E, U+200F, U+2028 to 202E
        (e281 && is(byte(2), 0xa6, 0xa9))) {                              // U+2066 to 2069
        return 3;
    }
    return 0;
}

} // namespace

std::string quotable(std::string_view text, std::size_t bytes_max) {
    const bool cut = text.size() > bytes_max;
    if (cut) {
        std::size_t end = bytes_max;
        while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) {
            --end; // do not cut within a character
        }
        text = text.substr(0, end);
    }
    std::string quoted;
    while (!text.empty()) {
        const std::size_t steering = unsafe_character_bytes(text);
        quoted += steering > 0 ? '?' : text[0];
        text.remove_prefix(std::max<std::size_t>(steering, 1));
    }
    return cut ? quoted + "…" : quoted;
}

base::Refusal with_paths(base::Refusal refused, const std::string& request_name) {
    for (base::Violation& violation : refused.violations) {
        if (!violation.field.starts_with(request_name + ".")) {
            violation.field = request_name + "." + violation.field;
        }
    }
    return refused;
}

} // namespace evod::protocol
