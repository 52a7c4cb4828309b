// Fuzzes requests: any bytes of a message are parsed, checked and converted into a command, or refused with field
// names.
#include "evod/v1/session.pb.h"
#include "proto/codec/framing.h"
#include "server/protocol/commands.h"
#include "server/protocol/refusals.h"
#include "server/protocol/request_rules.h"
#include "server/simulation/world_name.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace evod;
    const auto message = codec::parse_body<v1::ClientMessage>(std::as_bytes(std::span{data, size}));
    if (!message || !message->has_request()) {
        return 0;
    }
    const v1::Request& request = message->request();
    base::Refusal refusal;
    if (protocol::kind_of(request) == v1::REQUEST_KIND_COMMAND) {
        const auto command = protocol::to_command(request, {.seed = {1}, .run_id = {2, 3}});
        if (command) {
            // The core's input must be valid in itself.
            if (const auto* create = std::get_if<simulation::CreateWorld>(&*command)) {
                if (!simulation::is_world_name(create->name) || !parameters::validate(create->parameters).empty()) {
                    std::abort();
                }
            }
            if (const auto* set = std::get_if<simulation::SetParameters>(&*command)) {
                (void)parameters::assign({}, set->assignments);
            }
            return 0;
        }
        refusal = command.error();
        if (refusal.violations.empty()) {
            std::abort();
        }
    } else {
        refusal = {
            .code = base::RefusalCode::InvalidArgument, .message = "", .violations = protocol::faults_of(request)};
    }
    if (protocol::refusing(request.request_id(), refusal).ByteSizeLong() > (1u << 20)) {
        std::abort();
    }
    return 0;
}
