#include "client/ctl/qr_text.h"

#include <gtest/gtest.h>

namespace evod::ctl {
namespace {

TEST(QrText, DrawsTwoRowsInALine) {
    v1::QrCode code;
    code.set_size(3);
    code.set_modules(std::string{1, 0, 1, 0, 1, 0, 1, 1, 1});
    EXPECT_EQ(qr_text(code, false), "███████████\n"
                                    "███████████\n"
                                    "████▄▀▄████\n"
                                    "████▄▄▄████\n"
                                    "███████████\n"
                                    "▀▀▀▀▀▀▀▀▀▀▀\n");
    EXPECT_TRUE(qr_text(code, true).starts_with("\033[40;97m█"));
}

TEST(QrText, AMalformedCodeIsNotDrawn) {
    v1::QrCode code;
    EXPECT_EQ(qr_text(code, false), "");
    code.set_size(3);
    code.set_modules("12345678");
    EXPECT_EQ(qr_text(code, false), "");
    code.set_size(70'000);
    EXPECT_EQ(qr_text(code, false), "");
}

} // namespace
} // namespace evod::ctl
