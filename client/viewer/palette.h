// Palette: every colour of the window.
//
// Food and poison differ in lightness as well as in hue, so that they can be told apart without seeing red and green.
#pragma once

#include <cstdint>

namespace evod::viewer {

struct Colour {
    std::uint8_t red = 0, green = 0, blue = 0, alpha = 255;
    friend bool operator==(const Colour&, const Colour&) = default;
};

namespace palette {

constexpr Colour background{204, 204, 204};
constexpr Colour wall{0, 0, 0};
constexpr Colour organism{104, 22, 148};
constexpr Colour organism_pointed_at{190, 60, 250};
constexpr Colour food{62, 176, 76};
constexpr Colour poison{196, 22, 36};
constexpr Colour crate{190, 148, 96};
constexpr Colour crate_edge{104, 74, 38};
constexpr Colour obstacle{92, 94, 100};
constexpr Colour health{20, 20, 24};

constexpr Colour strip{230, 230, 232};
constexpr Colour strip_edge{150, 150, 154};
constexpr Colour text{24, 24, 28};
constexpr Colour text_quiet{92, 92, 100};
constexpr Colour running{22, 118, 48};
constexpr Colour stopped{168, 84, 0};

constexpr Colour note{38, 38, 44, 232};
constexpr Colour note_text{244, 244, 246};
constexpr Colour warning{140, 24, 28, 240};

constexpr Colour plot_background{252, 252, 253};
constexpr Colour plot_grid{226, 226, 230};
// Series, told apart by those who do not see red and green. Source: Okabe & Ito 2008, "Color universal design".
constexpr Colour series_blue{0, 114, 178};
constexpr Colour series_sky{86, 180, 233};
constexpr Colour series_green{0, 158, 115};
constexpr Colour series_orange{230, 159, 0};
constexpr Colour series_vermilion{213, 94, 0};
constexpr Colour series_purple{204, 121, 167};
constexpr Colour series_grey{110, 110, 116};

} // namespace palette
} // namespace evod::viewer
