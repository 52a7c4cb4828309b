// Actor: who has caused a change: a client, the server itself, or the schedule of an experiment.
//
// The parts of a client are separate fields. A client chooses the name of its program freely, so a text that joins the
// parts cannot be divided again.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace evod::base {

struct Actor {
    // Run files contain these numbers.
    enum class Kind : std::uint8_t { Schedule, Client, Server };

    Kind kind = Kind::Schedule;
    // The rest is empty unless kind is Client.
    std::string user = {};    // name of the session's token; empty: the session had no token
    std::string program = {}; // the name that the client states in its Hello
    std::string address = {}; // IP address and port

    friend bool operator==(const Actor&, const Actor&) = default;
};

inline Actor client_actor(std::string user, std::string program, std::string address) {
    return {Actor::Kind::Client, std::move(user), std::move(program), std::move(address)};
}
inline Actor server_actor() {
    return {Actor::Kind::Server};
}

/// The actor in a log line: "anna: evoview 127.0.0.1:51234", "evoview 127.0.0.1:51234" for a client without a token,
/// "evod" for the server. No function parses this text.
std::string to_text(const Actor& actor);

} // namespace evod::base
