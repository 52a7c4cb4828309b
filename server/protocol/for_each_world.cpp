#include "server/protocol/for_each_world.h"

#include "server/base/assert.h"
#include "server/protocol/commands.h"

#include <google/protobuf/descriptor.h>

#include <utility>

namespace evod::protocol {
namespace {

// Longer than any client_key, so that a client cannot send it as its own.
const std::string separator = std::string(client_key_bytes_max, ' ') + "for ";

} // namespace

bool acts_on_forks(const v1::Request& for_each_world) {
    return !for_each_world.for_each_world().has_reset_world();
}

v1::Request request_for(const v1::Request& for_each_world, const std::string& world) {
    v1::Request request;
    request.set_request_id(for_each_world.request_id());
    request.set_client_key(for_each_world.client_key());
    const v1::ForEachWorld& each = for_each_world.for_each_world();
    switch (each.action_case()) {
    case v1::ForEachWorld::kRun:
        *request.mutable_run() = each.run();
        request.mutable_run()->set_world(world);
        break;
    case v1::ForEachWorld::kPause:
        request.mutable_pause()->set_world(world);
        break;
    case v1::ForEachWorld::kResume:
        request.mutable_resume()->set_world(world);
        break;
    case v1::ForEachWorld::kSetSpeed:
        *request.mutable_set_speed() = each.set_speed();
        request.mutable_set_speed()->set_world(world);
        break;
    case v1::ForEachWorld::kSetParameters:
        *request.mutable_set_parameters() = each.set_parameters();
        request.mutable_set_parameters()->set_world(world);
        break;
    case v1::ForEachWorld::kResetWorld:
        *request.mutable_reset_world() = each.reset_world();
        request.mutable_reset_world()->set_world(world);
        break;
    case v1::ForEachWorld::ACTION_NOT_SET:
        EVOD_ASSERT(false);
    }
    return request;
}

std::optional<base::Refusal> refusal_of_action(const v1::Request& for_each_world) {
    const v1::ForEachWorld& each = for_each_world.for_each_world();
    if (each.class_().empty()) {
        return invalid({{"for_each_world.class", "the name of a class", "nothing"}});
    }
    if (each.action_case() == v1::ForEachWorld::ACTION_NOT_SET) {
        return invalid({{"for_each_world.action", "an action", "nothing"}});
    }
    const auto* action = v1::ForEachWorld::GetReflection()->GetOneofFieldDescriptor(
        each, v1::ForEachWorld::descriptor()->FindOneofByName("action"));
    const auto& message = each.GetReflection()->GetMessage(each, action);
    if (const auto world =
            message.GetReflection()->GetString(message, action->message_type()->FindFieldByName("world"));
        !world.empty()) {
        return invalid(
            {{"for_each_world." + action->name() + ".world", "nothing: the action is for all worlds", world}});
    }
    const auto command = to_command(request_for(for_each_world, "any"), {});
    if (command) {
        return std::nullopt;
    }
    std::vector<base::Violation> violations = command.error().violations;
    for (base::Violation& violation : violations) {
        if (violation.field != "client_key") {
            violation.field.insert(0, "for_each_world.");
        }
    }
    return invalid(std::move(violations));
}

std::string key_for(std::string_view client_key, std::string_view world) {
    return std::string{client_key} + separator + std::string{world};
}

std::optional<std::string> key_of_batch(std::string_view key) {
    const std::size_t end = key.rfind(separator);
    return end == std::string_view::npos ? std::nullopt : std::optional{std::string{key.substr(0, end)}};
}

} // namespace evod::protocol
