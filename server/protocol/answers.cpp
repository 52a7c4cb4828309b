#include "server/protocol/answers.h"

#include "evod/v1/session.pb.h"
#include "proto/codec/framing.h"
#include "proto/text/number_text.h"
#include "server/protocol/entities.h"
#include "server/protocol/parameters.h"
#include "server/protocol/refusals.h"
#include "server/protocol/worlds.h"

#include <algorithm>
#include <optional>
#include <string>
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

/// Above this number of organisms, a tick takes so long that answers can take more than 0.1 s on two cores,
/// because nothing interrupts a tick (tests/bench/class_cost.py).
constexpr std::uint64_t organisms_undisturbing_max = 500'000;

/// Says that a world that begins will slow the worlds of classes; nullopt: it will not.
std::optional<std::string> disturbance_by(const simulation::Entry& world, const simulation::Laboratory& laboratory) {
    const parameters::Parameters& requested = world.world.parameters().requested.values;
    const std::uint64_t organisms = std::uint64_t{requested.island_count} * requested.population_size;
    const auto others = std::ranges::count_if(laboratory.entries(), [&](const auto& other) {
        return !other->ownership.class_name.empty() && other->ownership.class_name != world.ownership.class_name;
    });
    if (organisms <= organisms_undisturbing_max || others == 0) {
        return std::nullopt;
    }
    return "a tick of " + text::with_separators(organisms) +
           " organisms cannot be interrupted: while this world runs, answers to the " + std::to_string(others) +
           " worlds of classes on this server can take more than 0.1 s, and they may fall behind real time";
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
    const auto entry = laboratory.find(applied->world);
    if (entry && (request_name == "create_world" || request_name == "reset_world" || request_name == "run")) {
        if (auto disturbance = disturbance_by(**entry, laboratory)) {
            response.add_warnings(*std::move(disturbance));
        }
    }
    return response;
}

std::string frame_of(v1::Response response) {
    v1::ServerMessage message;
    *message.mutable_response() = std::move(response);
    return codec::encode_frame(codec::Channel::Control, message);
}

} // namespace evod::protocol
