#include "server/protocol/answers.h"

#include "evod/v1/session.pb.h"
#include "proto/codec/framing.h"
#include "server/protocol/entities.h"
#include "server/protocol/parameters.h"
#include "server/protocol/refusals.h"
#include "server/protocol/worlds.h"

#include <optional>
#include <utility>

namespace evod::protocol {
namespace {

/// Returns the parameters that CreateWorld, ResetWorld or SetParameters has requested. A planned change counts as
/// applied. nullopt: the command was another one.
std::optional<parameters::RequestedParameters> requested_by(const std::string& request_name,
                                                            const simulation::Laboratory& laboratory,
                                                            const simulation::Applied& applied) {
    if (applied.parameters) {
        return applied.parameters->requested;
    }
    const auto entry = laboratory.find(applied.world);
    if (entry && (request_name == "create_world" || request_name == "reset_world")) {
        return (*entry)->world.parameters().requested;
    }
    if (entry && request_name == "set_parameters" && applied.planned) {
        const auto requested = parameters::assign((*entry)->world.parameters().requested, applied.planned->assignments);
        return requested ? std::optional{*requested} : std::nullopt;
    }
    return std::nullopt;
}

} // namespace

v1::Response answer_of(std::uint64_t request_id, const std::string& request_name,
                       const simulation::Laboratory& laboratory, const base::Result<simulation::Applied>& applied) {
    if (!applied) {
        return refusing(request_id, with_paths(applied.error(), request_name));
    }
    v1::Response response;
    response.set_request_id(request_id);
    response.set_applied_tick(applied->tick);
    if (applied->planned) {
        *response.mutable_planned_change() = to_proto(*applied->planned);
    } else if (applied->parameters) {
        *response.mutable_parameters() =
            to_proto(*applied->parameters, laboratory.class_of(**laboratory.find(applied->world)));
    } else if (applied->placed) {
        *response.mutable_placed() = placed_message(*applied->placed);
    } else if (applied->removed) {
        *response.mutable_removed() = removed_message(*applied->removed);
    } else if (const auto entry = laboratory.find(applied->world)) { // a deleted world is not found
        *response.mutable_world() = to_proto(**entry);
    }
    if (const auto requested = requested_by(request_name, laboratory, *applied)) {
        add_warnings(response, *requested);
    }
    return response;
}

std::string frame_of(v1::Response response) {
    v1::ServerMessage message;
    *message.mutable_response() = std::move(response);
    return codec::encode_frame(codec::Channel::Control, message);
}

} // namespace evod::protocol
