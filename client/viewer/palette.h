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

// The glass box. Parents: Okabe & Ito 2008, "Color Universal Design", blue and orange.
constexpr Colour first_parent{0, 114, 178};
constexpr Colour second_parent{230, 159, 0};
constexpr Colour glass_current{206, 16, 110};
constexpr Colour glass_mutated{122, 36, 150};
constexpr Colour glass_elite{20, 20, 24};
constexpr Colour glass_survivor{104, 104, 112};
constexpr Colour glass_child{184, 184, 192};

} // namespace palette
} // namespace evod::viewer
