#include "server/protocol/refusals.h"

#include "proto/text/printable.h"
#include "server/protocol/public_text.h"

#include <algorithm>

namespace evod::protocol {
namespace {

// Maximum number of violations in an answer. Without a limit, a hostile request could cause an answer of several
// megabytes.
constexpr std::size_t violations_listed_max = 200;
constexpr int violations_shown_max = 20; // of them, those that the message contains

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
    std::string message = quotable(public_text(refusal.message), 2000);
    for (const base::Violation& violation : refusal.violations) {
        if (static_cast<std::size_t>(status.violations_size()) == violations_listed_max) {
            break;
        }
        v1::Violation& listed = *status.add_violations();
        listed.set_field(quotable(violation.field, 200));
        listed.set_allowed(quotable(public_text(violation.allowed), 2000));
        listed.set_got(violation.got.empty() ? "nothing" : quotable(public_text(violation.got), 200));
        const bool is_in_sentence = refusal.violations.size() == 1 && message.starts_with(listed.field() + ": ");
        if (!is_in_sentence && status.violations_size() <= violations_shown_max) {
            message += "\n  " + listed.field() + ": " + text::violation_text(listed.got(), listed.allowed());
        }
    }
    if (refusal.violations.size() > violations_shown_max) {
        message += "\n  and " + std::to_string(refusal.violations.size() - violations_shown_max) + " more fields";
    }
    status.set_message(std::move(message));
    for (const base::Argument& argument : refusal.arguments) {
        v1::Argument& to = *status.add_arguments();
        to.set_name(argument.name);
        to.set_value(quotable(public_text(argument.value), 200));
    }
    return status;
}

v1::Response refusing(std::uint64_t request_id, const base::Refusal& refusal) {
    v1::Response response;
    response.set_request_id(request_id);
    *response.mutable_status() = to_proto(refusal);
    return response;
}

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
    for (std::string_view rest = text; !rest.empty();) {
        const std::size_t steering = evod::text::unsafe_character_bytes(rest);
        quoted += steering > 0 ? '?' : rest[0];
        rest.remove_prefix(std::max<std::size_t>(steering, 1));
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
