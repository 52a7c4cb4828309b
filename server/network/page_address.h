// Page address: where browsers find the page of this server. The log and the Welcome contain it.
//
// Threads  any; plain values.
#pragma once

#include <boost/asio/ip/tcp.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace evod::network {

struct PageAddress {
    std::string host = {};  // name or IP address without brackets; empty: any name or address of this machine
    std::uint16_t port = 0; // 0: there is no page
    bool tls = false;       // https
    bool is_local = false;  // only programs on this machine can connect
};

/// host_names  names from the operator, which other machines can resolve; the first is used.
PageAddress page_address(const boost::asio::ip::tcp::endpoint& listening, const std::vector<std::string>& host_names,
                         bool tls);

/// "http://127.0.0.1:7745/". If the host is empty, the URL contains the name of this machine.
std::string url_of(const PageAddress& page);

} // namespace evod::network
