#include "server/protocol/hello.h"

#include "proto/codec/framing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace evod::protocol {
namespace {

v1::Hello hello_of(std::uint32_t lowest, std::uint32_t highest = 0) {
    v1::Hello hello;
    hello.set_protocol_version(lowest);
    hello.set_protocol_version_max(highest);
    return hello;
}

TEST(Hello, NeedsACommonProtocolVersion) {
    EXPECT_FALSE(refusal_of(hello_of(codec::protocol_version)));
    EXPECT_FALSE(refusal_of(hello_of(0, codec::protocol_version + 5)));
    const auto newer = refusal_of(hello_of(codec::protocol_version + 1, codec::protocol_version + 2));
    ASSERT_TRUE(newer);
    EXPECT_EQ(newer->reason, base::Reason::ProtocolVersion);
    EXPECT_EQ(newer->violations[0].got,
              std::to_string(codec::protocol_version + 1) + " to " + std::to_string(codec::protocol_version + 2));
}

TEST(Hello, NamesEveryInvalidField) {
    v1::Hello hello = hello_of(codec::protocol_version);
    hello.set_client_name(std::string(65, 'a'));
    hello.set_client_version(std::string(65, 'a'));
    hello.set_frame_bytes_max(65'535);
    const auto refused = refusal_of(hello);
    ASSERT_TRUE(refused);
    EXPECT_THAT(refused->violations,
                testing::ElementsAre(testing::Field(&base::Violation::field, "hello.client_name"),
                                     testing::Field(&base::Violation::field, "hello.client_version"),
                                     testing::Field(&base::Violation::field, "hello.frame_bytes_max")));
    hello.set_client_name(std::string(64, 'a'));
    hello.set_client_version("");
    hello.set_frame_bytes_max(65'536);
    EXPECT_FALSE(refusal_of(hello));
}

TEST(Hello, AClientKeepsItsName) {
    v1::Hello hello;
    EXPECT_EQ(client_name_of(hello), "unnamed");
    for (const char* name : {"evoctl", "anna: evoctl", "ada:", "a: b", ": ", "evod"}) {
        hello.set_client_name(name);
        EXPECT_EQ(client_name_of(hello), name);
    }
}

} // namespace
} // namespace evod::protocol
