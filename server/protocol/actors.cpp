#include "server/protocol/actors.h"

#include <google/protobuf/descriptor.h>

#include <vector>

namespace evod::protocol {

v1::Actor actor_of_kind(v1::ActorKind kind) {
    v1::Actor actor;
    actor.set_kind(kind);
    return actor;
}

v1::Actor to_proto(const base::Actor& actor) {
    switch (actor.kind) {
    case base::Actor::Kind::Schedule:
        return actor_of_kind(v1::ACTOR_KIND_SCHEDULE);
    case base::Actor::Kind::Server:
        return actor_of_kind(v1::ACTOR_KIND_SERVER);
    case base::Actor::Kind::Client:
        break;
    }
    v1::Actor to = actor_of_kind(v1::ACTOR_KIND_CLIENT);
    to.set_user(actor.user);
    to.set_client(actor.program);
    to.set_address(actor.address);
    return to;
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
