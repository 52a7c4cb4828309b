#include "server/protocol/actors.h"

#include <google/protobuf/descriptor.h>

#include <string>
#include <vector>

namespace evod::protocol {

v1::Actor actor_of_kind(v1::ActorKind kind) {
    v1::Actor actor;
    actor.set_kind(kind);
    return actor;
}

v1::Actor actor_of(std::string_view by) {
    if (by == by_the_server) {
        return actor_of_kind(v1::ACTOR_KIND_SERVER);
    }
    v1::Actor actor = actor_of_kind(v1::ACTOR_KIND_CLIENT);
    if (const auto end = by.find(": "); end != std::string_view::npos) { // no client's name contains ": "
        actor.set_user(std::string{by.substr(0, end)});
        by.remove_prefix(end + 2);
    }
    const auto end = by.rfind(' ');
    actor.set_client(std::string{by.substr(0, end)});
    if (end != std::string_view::npos) {
        actor.set_address(std::string{by.substr(end + 1)});
    }
    return actor;
}

void keep_users_only(google::protobuf::Message& message) {
    if (auto* actor = dynamic_cast<v1::Actor*>(&message)) {
        actor->clear_client();
        actor->clear_address();
        return;
    }
    const google::protobuf::Reflection& in = *message.GetReflection();
    std::vector<const google::protobuf::FieldDescriptor*> fields;
    in.ListFields(message, &fields);
    for (const auto* field : fields) {
        if (field->cpp_type() != google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE) {
            continue;
        }
        if (!field->is_repeated()) {
            keep_users_only(*in.MutableMessage(&message, field));
        } else {
            for (int i = 0; i < in.FieldSize(message, field); ++i) {
                keep_users_only(*in.MutableRepeatedMessage(&message, field, i));
            }
        }
    }
}

} // namespace evod::protocol
