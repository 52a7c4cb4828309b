// Page link: the URL at which a browser shows a moment of a world. client/python/evod/page_link.py and
// client/web/src/page/link.ts use the same form.
#pragma once

#include "client/core/client_types.h"
#include "evod/v1/world.pb.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace evod::core {

struct PageMoment {
    std::string world;
    std::optional<std::uint64_t> generation = {}; // nullopt: the world as it runs
    std::uint64_t tick = 0;                       // since the generation began
    std::optional<std::uint32_t> island = {}, organism = {};
};

/// The present moment of a world. For a replay: the moment that it shows of its original.
PageMoment moment_of(const evod::v1::WorldInfo& world);

/// Whether a URL can contain all characters of a text, which may come from a server.
bool fits_into_url(std::string_view text);

/// The page of a server, such as "http://lab:7745/". Empty if there is none that this client can reach, or if its host
/// is not one.
///
/// server, tls  how this client is connected.
std::string page_of(const evod::v1::Welcome& welcome, const Endpoint& server, bool tls);

/// The host of the page if it is another one than that to which this client has connected. Empty: it is the same.
std::string other_page_host(const evod::v1::Welcome& welcome, const Endpoint& server);

/// Whether a link leads to the loopback interface, which no other device can reach.
bool is_of_this_machine(std::string_view link);

/// "http://lab:7745/#world=default&generation=12&tick=600&island=0&organism=7". Never contains a token.
std::string link_of(const std::string& page, const PageMoment& moment);

} // namespace evod::core
