#include "server/network/http_rules.h"

#include <gmock/gmock.h>

namespace evod::network {
namespace {

using boost::asio::ip::make_address;
using testing::HasSubstr;

TEST(HostNames, AreThoseOfTheMachineAndOfTheOperator) {
    const auto names = HostNames::make(make_address("192.168.1.5"), "Laptop", {"lab.example.org", "2001:db8::1"});
    ASSERT_TRUE(names);
    const auto arrived = make_address("::ffff:10.0.0.7");
    for (const char* host :
         {"localhost", "LocalHost:7745", "localhost.", "127.0.0.1:1", "[::1]", "[0:0::1]:80", "192.168.1.5", "laptop",
          "LAPTOP:7745", "lab.example.org:443", "[2001:DB8::1]", "10.0.0.7:7745"}) {
        EXPECT_TRUE(names->allows(host, arrived)) << host;
    }
    for (const char* host : {"", ".", ":7745", "evil.example", "localhost.evil.example", "10.0.0.8", "[::2]", "::1",
                             "[::1", "[]", "[::1]x", "localhost:", "localhost:x", "localhost:70000", "localhost:80:80",
                             "localhost/", "a@localhost", "127.1"}) {
        EXPECT_FALSE(names->allows(host, arrived)) << host;
    }
}

TEST(HostNames, HaveNoZone) {
    const auto names = HostNames::make(make_address("fe80::1%1"), "", {});
    ASSERT_TRUE(names);
    EXPECT_TRUE(names->allows("[fe80::1]:7745", make_address("::1")));
    EXPECT_TRUE(names->allows("[fe80::2]:7745", make_address("fe80::2%1")));
    for (const char* host : {"[::1%1]", "[::1%0; script-src *]:80"}) {
        EXPECT_FALSE(names->allows(host, make_address("::1"))) << host;
    }
}

TEST(HostNames, OtherTextsAreRefusedByTheirOption) {
    for (const char* name : {"", "a b", "http://lab", "lab;script-src", "lab/", "fe80::1%x"}) {
        const auto names = HostNames::make(make_address("0.0.0.0"), "", {name});
        ASSERT_FALSE(names) << name;
        EXPECT_THAT(names.error().message, HasSubstr("--http-host: got '" + std::string{name} + "', allowed"));
    }
}

TEST(Origin, IsThatOfTheHost) {
    EXPECT_TRUE(is_own_origin("http://localhost:7745", "localhost:7745", false));
    EXPECT_TRUE(is_own_origin("HTTP://LOCALHOST:7745", "localhost:7745", false));
    EXPECT_TRUE(is_own_origin("https://lab.example", "lab.example", false)) << "a proxy speaks TLS";
    EXPECT_TRUE(is_own_origin("https://lab.example", "lab.example", true));
    EXPECT_FALSE(is_own_origin("http://lab.example", "lab.example", true));
    for (const char* origin : {"", "null", "localhost:7745", "http://localhost", "http://localhost:7745/",
                               "http://localhost:77456", "http://127.0.0.1:7745", "file://localhost:7745"}) {
        EXPECT_FALSE(is_own_origin(origin, "localhost:7745", false)) << origin;
    }
}

TEST(ContentSecurityPolicy, AllowsSessionsOfTheHostOnly) {
    EXPECT_THAT(content_security_policy("lab:1", false, {}),
                HasSubstr("connect-src 'self' ws://lab:1 wss://lab:1; base"));
    EXPECT_THAT(content_security_policy("lab:1", true, {}), HasSubstr("connect-src 'self' wss://lab:1; base"));
    EXPECT_THAT(content_security_policy("", true, {}), HasSubstr("connect-src 'self'; base"));
}

TEST(ContentSecurityPolicy, FramesAreForNamedOriginsOnly) {
    EXPECT_THAT(content_security_policy("lab:1", false, {}), HasSubstr("; frame-ancestors 'none'; require"));
    EXPECT_THAT(content_security_policy("lab:1", false, {"http://localhost:8888", "https://hub.example"}),
                HasSubstr("; frame-ancestors http://localhost:8888 https://hub.example; require"));
}

TEST(ContentSecurityPolicy, AnEmbedderIsAnOrigin) {
    for (const char* origin : {"http://localhost:8888", "http://localhost:*", "https://hub.example.org",
                               "http://127.0.0.1:8888", "http://my_host-1"}) {
        EXPECT_EQ(embedder_problem(origin), "") << origin;
    }
    for (const char* origin :
         {"", "localhost:8888", "http://", "http://:80", "http://a b", "http://lab/", "http://lab:70000",
          "http://lab:8:*", "http://*", "*", "'self'", "http://lab;script-src", "http://lab,http://b", "file://lab",
          "HTTP://lab", "http://[::1]:8888", "http://lab\r\nX: y", "http://user@lab"}) {
        EXPECT_THAT(embedder_problem(origin), HasSubstr("such as http://localhost:8888")) << origin;
    }
}

TEST(AcceptEncoding, GzipMayBeNamedOrImplied) {
    for (const char* field :
         {"gzip", "br, GZIP", "gzip;q=0.001", "*", "identity;q=0, *;q=0.5", "deflate,gzip ; q=1.0"}) {
        EXPECT_TRUE(accepts_gzip(field)) << field;
    }
    for (const char* field : {"", "br", "identity", "gzip;q=0", "gzip; q=0.000, *", "*;q=0", "xgzip"}) {
        EXPECT_FALSE(accepts_gzip(field)) << field;
    }
}

TEST(EntityTags, AreFoundInAList) {
    for (const char* field : {"\"a\"", "\"b\", \"a\"", "W/\"a\"", "*", " \"a\" ,"}) {
        EXPECT_TRUE(has_entity_tag(field, "\"a\"")) << field;
    }
    for (const char* field : {"", "a", "\"aa\"", "\"b\",", "w/\"a\""}) {
        EXPECT_FALSE(has_entity_tag(field, "\"a\"")) << field;
    }
}

TEST(BearerToken, FollowsItsScheme) {
    EXPECT_EQ(bearer_token("Bearer evod_1"), "evod_1");
    EXPECT_EQ(bearer_token("bearer   evod_1 "), "evod_1");
    for (const char* field : {"", "Bearer", "Basic evod_1", "Bearerevod_1", "evod_1"}) {
        EXPECT_EQ(bearer_token(field), "") << field;
    }
}

} // namespace
} // namespace evod::network
