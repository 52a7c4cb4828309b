#include "client/core/client_types.h"

#include <boost/throw_exception.hpp>

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace evod::core {

namespace {

Error malformed(std::string_view text, const std::string& why) {
    return {.kind = Error::Kind::Usage,
            .what = "got " + std::string{text} + ", allowed HOST, HOST:PORT or [IPV6]:PORT: " + why};
}

} // namespace

void throw_exception_from_error(const Error& error, const boost::source_location& where) {
    boost::throw_exception(std::runtime_error{error.what}, where);
}

Result<Endpoint> parse_endpoint(std::string_view text) {
    std::string_view host = text, port;
    bool has_port = false;
    if (text.starts_with('[')) {
        const auto close = text.find(']');
        if (close == std::string_view::npos) {
            return malformed(text, "']' is missing");
        }
        host = text.substr(1, close - 1);
        const auto rest = text.substr(close + 1);
        if (!rest.empty() && rest.front() != ':') {
            return malformed(text, "']' must be followed by ':' and a port");
        }
        has_port = !rest.empty();
        port = rest.substr(has_port ? 1 : 0);
    } else if (std::ranges::count(text, ':') == 1) {
        has_port = true;
        host = text.substr(0, text.find(':'));
        port = text.substr(text.find(':') + 1);
    }
    if (host.empty()) {
        return malformed(text, "the host is missing");
    }
    Endpoint endpoint{.host = std::string{host}};
    if (has_port) {
        const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), endpoint.port);
        if (error != std::errc{} || end != port.data() + port.size() || endpoint.port == 0) {
            return malformed(text, "a port is a number from 1 to 65535");
        }
    }
    return endpoint;
}

std::string to_text(const Endpoint& endpoint) {
    const bool bracketed = endpoint.host.find(':') != std::string::npos;
    return (bracketed ? "[" + endpoint.host + "]" : endpoint.host) + ":" + std::to_string(endpoint.port);
}

std::string to_text(const evod::v1::Status& status, const std::function<std::string(std::string_view path)>& name_of) {
    std::string text = !status.message().empty()               ? status.message()
                       : evod::v1::Code_IsValid(status.code()) ? evod::v1::Code_Name(status.code())
                                                               : "unknown code " + std::to_string(status.code());
    for (const auto& violation : status.violations()) {
        const std::size_t at = violation.field().empty() ? std::string::npos : text.find(violation.field() + ": ");
        if (name_of && at != std::string::npos) {
            text.replace(at, violation.field().size(), name_of(violation.field()));
        }
    }
    return text;
}

std::string to_text(const evod::v1::Event& event) {
    return event.text().empty() ? event.ShortDebugString() : event.text();
}

std::string to_text(const evod::v1::AwaitedFitness& awaited, std::uint32_t island_count) {
    const auto unrated = static_cast<std::uint32_t>(awaited.islands_size());
    return std::to_string(island_count - std::min(unrated, island_count)) + " of " + std::to_string(island_count) +
           (island_count == 1 ? " island rated" : " islands rated");
}

const char* to_text(State state) {
    constexpr const char* texts[] = {"connecting", "connected", "lost", "failed"};
    return texts[static_cast<std::size_t>(state)];
}

} // namespace evod::core
