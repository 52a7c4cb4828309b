#include "client/core/session_requests.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

namespace evod::core {

std::string replay_in(const evod::v1::Request& request) {
    const auto* const kind =
        request.GetReflection()->GetOneofFieldDescriptor(request, request.GetDescriptor()->FindOneofByName("kind"));
    if (kind == nullptr) {
        return {};
    }
    const auto& fields = request.GetReflection()->GetMessage(request, kind);
    const auto* const world = fields.GetDescriptor()->FindFieldByName("world");
    std::string name = world == nullptr ? "" : fields.GetReflection()->GetString(fields, world);
    return name.find('@') == std::string::npos ? "" : name;
}

bool ends_with_session(const evod::v1::Request& request) {
    return request.has_unsubscribe() || request.has_request_keyframe() || request.has_set_view() ||
           request.has_continue_export() || !replay_in(request).empty();
}

evod::v1::Status replay_has_ended(const std::string& replay) {
    evod::v1::Status status;
    status.set_code(evod::v1::CODE_NOT_FOUND);
    status.set_reason(evod::v1::REASON_WORLD_NOT_FOUND);
    status.set_message("the replay " + replay + " has ended with its session");
    return status;
}

} // namespace evod::core
