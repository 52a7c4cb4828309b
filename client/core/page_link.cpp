#include "client/core/page_link.h"

#include <algorithm>

namespace evod::core {

namespace {

/// Whether a text is the name or address of a host. A URL with other characters could lead elsewhere than it seems.
bool is_host(std::string_view text) {
    return std::ranges::all_of(text, [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
               std::string_view{"._:%-"}.find(c) != std::string_view::npos;
    });
}

/// Whether the name or address is one of the loopback interface.
bool is_this_machine(std::string_view host) {
    return host == "localhost" || host == "::1" ||
           (host.starts_with("127.") && host.find_first_not_of("0123456789.") == std::string_view::npos);
}

} // namespace

bool fits_into_url(std::string_view text) {
    return std::ranges::none_of(text, [](unsigned char character) {
        return character <= ' ' || character >= 0x7f ||
               std::string_view{"#\"<>\\^`{|}"}.find(static_cast<char>(character)) != std::string_view::npos;
    });
}

PageMoment moment_of(const evod::v1::WorldInfo& world) {
    const std::string& original = world.replay().replay_of();
    return {.world = original.empty() ? world.name() : original,
            .generation = world.generation(),
            .tick = world.generation_tick()};
}

std::string page_of(const evod::v1::Welcome& welcome, const Endpoint& server, bool tls) {
    if (welcome.page_port() == 0 || !is_host(welcome.page_host())) {
        return "";
    }
    const Endpoint page{.host = welcome.page_host().empty() ? server.host : welcome.page_host(),
                        .port = static_cast<std::uint16_t>(welcome.page_port())};
    return (tls ? "https://" : "http://") + to_text(page) + "/";
}

std::string other_page_host(const evod::v1::Welcome& welcome, const Endpoint& server) {
    const std::string& host = welcome.page_host();
    return host == server.host || (is_this_machine(host) && is_this_machine(server.host)) ? "" : host;
}

bool is_of_this_machine(std::string_view link) {
    std::string_view host = link.substr(std::min(link.find("://") + 3, link.size()));
    host = host.substr(0, host.find_first_of("/#"));
    host = host.starts_with('[') ? host.substr(1, host.find(']') - 1) : host.substr(0, host.find(':'));
    return is_this_machine(host);
}

std::string link_of(const std::string& page, const PageMoment& moment) {
    std::string link = page + "#world=" + moment.world;
    const auto add = [&link](const char* name, std::uint64_t value) {
        link += "&" + (name + ("=" + std::to_string(value)));
    };
    if (moment.generation) {
        add("generation", *moment.generation);
        add("tick", moment.tick);
    }
    if (moment.island || moment.organism) {
        add("island", moment.island.value_or(0));
    }
    if (moment.organism) {
        add("organism", *moment.organism);
    }
    return link;
}

} // namespace evod::core
