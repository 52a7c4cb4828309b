// HTTP rules: what a request may ask for and what an answer says, as pure functions: which Host and Origin are ours,
// which encodings a browser accepts, which headers protect the page.
//
// The page controls the server, and on the loopback interface without a token. Host prevents that another site reaches
// the server under a name of its own (DNS rebinding), Origin that another site opens a session.
//
// Threads      any; nothing changes.
// Source       RFC 9110 (HTTP semantics), RFC 6455 section 10.2 (Origin), RFC 6750 (bearer tokens), CSP level 3.
#pragma once

#include "server/base/result.h"

#include <boost/asio/ip/address.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::network {

/// The names and addresses under which browsers may address this server.
class HostNames {
  public:
    /// bound    the address on which the server listens.
    /// machine  the name of this machine.
    /// others   further names and addresses. Refuses any other text.
    static base::Result<HostNames> make(const boost::asio::ip::address& bound, const std::string& machine,
                                        const std::vector<std::string>& others);

    /// field    the value of Host: a name or an address, perhaps with a port. Any port is allowed, because ports can be
    ///          forwarded.
    /// arrived  the address of this machine to which the connection was made.
    bool allows(std::string_view field, const boost::asio::ip::address& arrived) const;

  private:
    std::vector<std::string> names_;
};

/// Whether the page that opens a session came from this server.
///
/// host  the allowed value of Host.
/// tls   true: only https; false: http, or https by a proxy.
bool is_own_origin(std::string_view origin, std::string_view host, bool tls);

/// The value of Content-Security-Policy. It allows nothing but files and sessions of this server.
///
/// host       the allowed value of Host; empty: no sessions.
/// embedders  the origins whose pages may show this page in a frame, as embedder_problem() allows them.
std::string content_security_policy(std::string_view host, bool tls, const std::vector<std::string>& embedders);

/// What is wrong with an origin that may embed the page; empty: nothing. http://localhost:* means all ports.
std::string embedder_problem(const std::string& origin);

/// Whether a client with this Accept-Encoding takes gzip. Clients without the field (empty), such as curl, rarely
/// decompress, and get the plain bytes.
bool accepts_gzip(std::string_view accept_encoding);

/// Whether If-None-Match contains the entity tag, or "*".
bool has_entity_tag(std::string_view if_none_match, std::string_view etag);

/// The token in "Bearer TOKEN"; empty: the field contains none.
std::string bearer_token(std::string_view authorization);

} // namespace evod::network
