#include "server/protocol/request_rules.h"

#include <google/protobuf/descriptor.h>

namespace evod::protocol {
namespace {

/// Returns the field that contains the request; nullptr: this server does not know the request.
const google::protobuf::FieldDescriptor* field_of(const v1::Request& request) {
    return v1::Request::descriptor()->FindFieldByNumber(request.kind_case());
}

} // namespace

const v1::RequestRules* rules_of(const v1::Request& request) {
    const auto* field = field_of(request);
    return field != nullptr ? &field->options().GetExtension(v1::rules) : nullptr;
}

v1::RequestKind kind_of(const v1::Request& request) {
    const v1::RequestRules* rules = rules_of(request);
    return rules != nullptr ? rules->kind() : v1::REQUEST_KIND_UNSPECIFIED;
}

std::string name_of(const v1::Request& request) {
    const auto* field = field_of(request);
    return field != nullptr ? field->name() : std::string{};
}

std::string world_of(const v1::Request& request) {
    const auto* field = field_of(request);
    const auto* world = field != nullptr ? field->message_type()->FindFieldByName("world") : nullptr;
    if (world == nullptr) {
        return {};
    }
    const auto& message = request.GetReflection()->GetMessage(request, field);
    return message.GetReflection()->GetString(message, world);
}

} // namespace evod::protocol
