#include "client/core/page_link.h"

namespace evod::core {

PageMoment moment_of(const evod::v1::WorldInfo& world) {
    const std::string& original = world.replay().replay_of();
    return {.world = original.empty() ? world.name() : original,
            .generation = world.generation(),
            .tick = world.generation_tick()};
}

std::string page_of(const evod::v1::Welcome& welcome, const Endpoint& server, bool tls) {
    if (welcome.page_port() == 0) {
        return "";
    }
    const Endpoint page{.host = welcome.page_host().empty() ? server.host : welcome.page_host(),
                        .port = static_cast<std::uint16_t>(welcome.page_port())};
    return (tls ? "https://" : "http://") + to_text(page) + "/";
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
