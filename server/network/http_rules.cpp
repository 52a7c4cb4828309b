#include "server/network/http_rules.h"

#include <boost/beast/core/string.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>

namespace evod::network {
namespace {

using boost::beast::iequals;

bool is_letter_or_digit(char character) {
    return std::isalnum(static_cast<unsigned char>(character)) != 0;
}

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    return first == std::string_view::npos ? std::string_view{}
                                           : text.substr(first, text.find_last_not_of(" \t") + 1 - first);
}

/// The items of a list that commas separate.
std::vector<std::string_view> items_of(std::string_view list) {
    std::vector<std::string_view> items;
    for (;;) {
        const auto comma = list.find(',');
        items.push_back(trimmed(list.substr(0, comma)));
        if (comma == std::string_view::npos) {
            return items;
        }
        list.remove_prefix(comma + 1);
    }
}

/// The name or address of a Host, in lower case and without port, brackets and final dot; nullopt if it is neither.
std::optional<std::string> name_of_host(std::string_view field) {
    std::string name;
    std::string_view rest;
    if (field.starts_with('[')) {
        const auto end = field.find(']');
        boost::system::error_code error;
        const std::string_view text = field.substr(1, end - 1);
        const auto address = boost::asio::ip::make_address_v6(std::string{text}, error);
        // make_address_v6() accepts any text after '%'.
        if (end == std::string_view::npos || error || text.find('%') != std::string_view::npos) {
            return std::nullopt;
        }
        name = address.to_string();
        rest = field.substr(end + 1);
    } else {
        const auto end = std::min(field.find(':'), field.size());
        const bool sound = std::ranges::all_of(field.substr(0, end), [](char character) {
            return is_letter_or_digit(character) || character == '-' || character == '.' || character == '_';
        });
        if (!sound) {
            return std::nullopt;
        }
        name = field.substr(0, end);
        rest = field.substr(end);
    }
    if (!rest.empty()) {
        std::uint16_t port = 0;
        const auto [end, error] = std::from_chars(rest.data() + 1, rest.data() + rest.size(), port);
        if (rest.front() != ':' || error != std::errc{} || end != rest.data() + rest.size()) {
            return std::nullopt;
        }
    }
    if (name.ends_with('.')) {
        name.pop_back();
    }
    std::ranges::transform(name, name.begin(), [](unsigned char character) { return std::tolower(character); });
    return name.empty() ? std::nullopt : std::optional{name};
}

/// The address as a browser writes it: without an IPv6 zone.
std::string text_of(const boost::asio::ip::address& address) {
    if (!address.is_v6()) {
        return address.to_string();
    }
    auto v6 = address.to_v6();
    if (v6.is_v4_mapped()) {
        return boost::asio::ip::make_address_v4(boost::asio::ip::v4_mapped, v6).to_string();
    }
    v6.scope_id(0);
    return v6.to_string();
}

} // namespace

base::Result<HostNames> HostNames::make(const boost::asio::ip::address& bound, const std::string& machine,
                                        const std::vector<std::string>& others) {
    HostNames all;
    all.names_ = {"localhost", "127.0.0.1", "::1"};
    if (!bound.is_unspecified()) {
        all.names_.push_back(text_of(bound));
    }
    if (auto name = name_of_host(machine)) {
        all.names_.push_back(*std::move(name));
    }
    for (const std::string& other : others) {
        boost::system::error_code error;
        const auto address = boost::asio::ip::make_address(other, error);
        const bool is_address = !error && other.find('%') == std::string::npos; // browsers send no IPv6 zone
        auto name = is_address ? std::optional{text_of(address)} : name_of_host(other);
        if (!name) {
            return refusal(base::RefusalCode::InvalidArgument,
                           "--http-host: got '" + other +
                               "', allowed a host name or an IP address, such as evod.example.org");
        }
        all.names_.push_back(*std::move(name));
    }
    return all;
}

bool HostNames::allows(std::string_view field, const boost::asio::ip::address& arrived) const {
    const auto name = name_of_host(field);
    return name && (std::ranges::find(names_, *name) != names_.end() || *name == text_of(arrived));
}

bool is_own_origin(std::string_view origin, std::string_view host, bool tls) {
    const auto is = [&](std::string_view scheme) {
        return origin.size() == scheme.size() + host.size() && iequals(origin.substr(0, scheme.size()), scheme) &&
               iequals(origin.substr(scheme.size()), host);
    };
    return is("https://") || (!tls && is("http://"));
}

std::string content_security_policy(std::string_view host, bool tls, const std::vector<std::string>& embedders) {
    std::string sessions;
    if (!host.empty()) {
        sessions = (tls ? " wss://" : " ws://" + std::string{host} + " wss://") + std::string{host};
    }
    std::string ancestors = embedders.empty() ? " 'none'" : "";
    for (const std::string& embedder : embedders) {
        ancestors += ' ' + embedder;
    }
    return "default-src 'none'; script-src 'self'; worker-src 'self'; style-src 'self'; img-src 'self' blob:; "
           "connect-src 'self'" +
           sessions + "; base-uri 'none'; form-action 'none'; frame-ancestors" + ancestors +
           "; require-trusted-types-for 'script'; trusted-types evod";
}

std::string embedder_problem(const std::string& origin) {
    std::string_view host = origin;
    for (const std::string_view scheme : {"https://", "http://"}) {
        if (host.starts_with(scheme)) {
            host.remove_prefix(scheme.size());
            break;
        }
    }
    const bool has_scheme = host.size() < origin.size();
    const bool has_all_ports = host.ends_with(":*");
    host.remove_suffix(has_all_ports ? 2 : 0);
    const bool has_port = host.find(':') != std::string_view::npos; // a policy cannot contain an IPv6 address
    return has_scheme && !host.starts_with('[') && !(has_all_ports && has_port) && name_of_host(host)
               ? ""
               : "got " + origin + ", allowed the origin of a page, such as http://localhost:8888, or " +
                     "http://localhost:* for all its ports";
}

bool accepts_gzip(std::string_view accept_encoding) {
    bool accepts_all = false;
    for (const std::string_view item : items_of(accept_encoding)) {
        const auto semicolon = item.find(';');
        const std::string_view name = trimmed(item.substr(0, semicolon));
        const std::string_view weight =
            semicolon == std::string_view::npos ? std::string_view{} : trimmed(item.substr(semicolon + 1));
        // A weight of 0 refuses: "q=0", "q=0.000".
        const bool accepts =
            !(weight.starts_with("q=") && weight.substr(2).find_first_not_of("0.") == std::string_view::npos);
        if (iequals(name, "gzip") || iequals(name, "x-gzip")) {
            return accepts;
        }
        accepts_all = accepts_all || (name == "*" && accepts);
    }
    return accepts_all;
}

bool has_entity_tag(std::string_view if_none_match, std::string_view etag) {
    return std::ranges::any_of(items_of(if_none_match), [&](std::string_view item) {
        if (item.starts_with("W/")) { // this comparison is the weak one, RFC 9110 section 13.1.2
            item.remove_prefix(2);
        }
        return item == etag || item == "*";
    });
}

std::string bearer_token(std::string_view authorization) {
    constexpr std::string_view scheme = "bearer ";
    if (!iequals(authorization.substr(0, scheme.size()), scheme)) {
        return {};
    }
    return std::string{trimmed(authorization.substr(scheme.size()))};
}

} // namespace evod::network
