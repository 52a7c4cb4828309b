#include "server/network/messages.h"

#include "proto/codec/framing.h"
#include "server/log/log.h"
#include "server/protocol/answers.h"
#include "server/protocol/event_text.h"
#include "server/protocol/refusals.h"

#include <chrono>
#include <memory>
#include <utility>

namespace evod::network {

void log_refusal(std::uint64_t session, const std::string& by, std::uint64_t request_id, const base::Refusal& refused) {
    log_refusal(session, by, protocol::refusing(request_id, refused));
}

void log_refusal(std::uint64_t session, const std::string& by, const v1::Response& response) {
    if (response.status().code() == v1::CODE_UNSPECIFIED) {
        return;
    }
    const char* code = name_of(static_cast<base::RefusalCode>(response.status().code()));
    std::string message = response.status().message(); // on one line
    for (std::size_t end = 0; (end = message.find("\n  ", end)) != std::string::npos;) {
        message.replace(end, 3, "; ");
    }
    log::debug({.session = session, .client = by, .code = code}, "session {}: {}: request {} is refused: {}: {}",
               session, by, response.request_id(), code, message);
}

v1::Response response_to(std::uint64_t request_id) {
    v1::Response response;
    response.set_request_id(request_id);
    return response;
}

SharedBytes encode_control(const v1::ServerMessage& message) {
    return std::make_shared<const std::string>(codec::encode_frame(codec::Channel::Control, message));
}

SharedBytes encode_response(v1::Response response) {
    return std::make_shared<const std::string>(protocol::frame_of(std::move(response)));
}

SharedBytes encode_goodbye(const base::Refusal& why) {
    v1::ServerMessage message;
    *message.mutable_goodbye()->mutable_status() = protocol::to_proto(why);
    return encode_control(message);
}

SharedBytes encode_event(v1::Event event) {
    using namespace std::chrono;
    event.set_time_ms(duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count());
    event.set_text(protocol::event_text(event));
    v1::ServerMessage message;
    *message.mutable_event() = std::move(event);
    return encode_control(message);
}

} // namespace evod::network
