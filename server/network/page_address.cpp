#include "server/network/page_address.h"

#include <boost/asio/ip/host_name.hpp>

namespace evod::network {

PageAddress page_address(const boost::asio::ip::tcp::endpoint& listening, const std::vector<std::string>& host_names,
                         bool tls) {
    const auto address = listening.address();
    PageAddress page{.port = listening.port(), .tls = tls, .is_local = address.is_loopback()};
    if (!page.is_local && !host_names.empty()) {
        page.host = host_names.front();
    } else if (!address.is_unspecified()) {
        page.host = address.to_string();
    }
    return page;
}

std::string url_of(const PageAddress& page) {
    std::string host = page.host;
    if (host.empty()) {
        boost::system::error_code error;
        host = boost::asio::ip::host_name(error);
    }
    if (host.find(':') != std::string::npos) {
        host = "[" + host + "]";
    }
    return (page.tls ? "https://" : "http://") + host + ":" + std::to_string(page.port) + "/";
}

} // namespace evod::network
