#include "server/network/page_address.h"

#include <gtest/gtest.h>

namespace evod::network {
namespace {

PageAddress page(const char* address, const std::vector<std::string>& names = {}, bool tls = false) {
    return page_address({boost::asio::ip::make_address(address), 7745}, names, tls);
}

TEST(PageAddress, IsTheListeningAddress) {
    EXPECT_EQ(url_of(page("127.0.0.1")), "http://127.0.0.1:7745/");
    EXPECT_EQ(url_of(page("::1")), "http://[::1]:7745/");
    EXPECT_EQ(url_of(page("192.0.2.1", {}, true)), "https://192.0.2.1:7745/");
    EXPECT_TRUE(page("127.0.0.1").is_local);
    EXPECT_FALSE(page("192.0.2.1").is_local);
}

TEST(PageAddress, OfAllInterfacesHasTheMachinesName) {
    EXPECT_EQ(page("0.0.0.0").host, "");
    EXPECT_EQ(page("::").host, "");
    EXPECT_NE(url_of(page("0.0.0.0")), "http://:7745/");
}

TEST(PageAddress, TakesTheOperatorsFirstName) {
    EXPECT_EQ(page("0.0.0.0", {"lab.example", "other"}).host, "lab.example");
    EXPECT_EQ(page("192.0.2.1", {"lab.example"}).host, "lab.example");
}

TEST(PageAddress, OnLoopbackIsNotTheOperatorsName) {
    EXPECT_EQ(page("127.0.0.1", {"lab.example"}).host, "127.0.0.1"); // a proxy has that name, and another port
}

} // namespace
} // namespace evod::network
