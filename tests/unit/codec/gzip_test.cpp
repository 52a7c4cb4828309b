#include "proto/codec/gzip.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace evod::codec {
namespace {

TEST(Gzip, KeepsEveryByte) {
    std::string bytes;
    for (int i = 0; i < 70'000; ++i) {
        bytes += static_cast<char>((i * i >> 3) % 251);
    }
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{1000}, bytes.size()}) {
        EXPECT_EQ(gunzip(gzip(bytes.substr(0, count))), bytes.substr(0, count));
    }
}

TEST(Gzip, MakesRepetitionsShorter) {
    EXPECT_LT(gzip(std::string(100'000, 'x')).size(), 1'000U);
}

TEST(Gzip, RefusesOtherBytes) {
    std::string changed = gzip("some text");
    changed[12] ^= 1;
    for (const std::string& bytes : {std::string{}, std::string{"abc"}, changed}) {
        EXPECT_THROW(gunzip(bytes), std::runtime_error) << bytes.size();
    }
}

} // namespace
} // namespace evod::codec
