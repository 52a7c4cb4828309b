// Palette: defines every colour of the window.
//
// Food and poison differ in lightness as well as in hue, so that red-green colour-blind users can distinguish them.
// Ordered numbers use a ramp of rising lightness. Categories use the colours of Okabe and Ito.
//
// The colours of an island depend on its skin. Bodies are violet in both skins. Violet differs from green and from red
// for every kind of colour vision, so that a body of any lightness is never confused with food or poison.
//
// Owner        none: constants.
// Threads      any.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace evod::viewer {

struct Colour {
    std::uint8_t red = 0, green = 0, blue = 0, alpha = 255;
    friend bool operator==(const Colour&, const Colour&) = default;
};

/// How islands are drawn: vivid has filled bodies; classic has hollow circles on grey, as the first version had.
enum class Skin : std::uint8_t { Vivid, Classic };
/// The background of the vivid skin. The classic skin is always grey.
enum class Background : std::uint8_t { Dark, Light };
struct Look {
    Skin skin = Skin::Vivid;
    Background background = Background::Dark;
    friend bool operator==(const Look&, const Look&) = default;
};

constexpr std::array<std::string_view, 2> skin_names{"vivid", "classic"};
constexpr std::array<std::string_view, 2> background_names{"dark", "light"};

namespace palette {

// Colours of the classic skin.
constexpr Colour background{204, 204, 204};
constexpr Colour wall{0, 0, 0};
constexpr Colour organism{104, 22, 148};
constexpr Colour predator{140, 64, 0};
constexpr Colour organism_pointed_at{190, 60, 250};
constexpr Colour food{62, 176, 76};
constexpr Colour poison{196, 22, 36};
constexpr Colour crate{190, 148, 96};
constexpr Colour crate_edge{104, 74, 38};
constexpr Colour obstacle{92, 94, 100};
constexpr Colour health{20, 20, 24};

constexpr Colour organism_outline{20, 20, 24};
constexpr Colour selected{255, 255, 255};
constexpr Colour food_radius{62, 176, 76, 220};
constexpr Colour poison_radius{140, 8, 24, 220};
constexpr Colour trail{70, 30, 100};
constexpr Colour unknown{140, 140, 144}; // for organisms without a value

constexpr Colour strip{230, 230, 232};
constexpr Colour strip_edge{150, 150, 154};
constexpr Colour text{24, 24, 28};
constexpr Colour text_quiet{92, 92, 100};
constexpr Colour running{22, 118, 48};
constexpr Colour stopped{168, 84, 0};

constexpr Colour replay{206, 142, 32}; // marks a world that shows a stored run
constexpr Colour focus{28, 98, 190};

constexpr Colour note{38, 38, 44, 232};
constexpr Colour note_text{244, 244, 246};
constexpr Colour warning{140, 24, 28, 240};

/// Colour ramps for numbers. Lightness rises with the number. Violet never resembles food or poison; viridis contains
/// green.
enum class Ramp { Violet, Viridis, Cividis };
constexpr std::array<Ramp, 3> ramps{Ramp::Violet, Ramp::Viridis, Ramp::Cividis};
std::string_view name_of(Ramp ramp);

/// Returns the colour at `share` of the ramp, clamped to 0 to 1; `unknown` if `share` is not a number.
///
/// Source   viridis and cividis: every 15th of the 256 colours of matplotlib, interpolated linearly. Viridis: S. van
///          der Walt and N. Smith,
///          2015. Cividis: Nuñez, Anderton & Renslow 2018, PLoS ONE 13(7), doi:10.1371/journal.pone.0199239.
Colour at(Ramp ramp, double share);

/// Colours for categories, distinguishable with every kind of colour vision.
///
/// Source   Okabe & Ito 2002, "Color Universal Design", without black, which is the colour of the walls.
constexpr std::array<Colour, 7> kinds{{
    {230, 159, 0},  // orange
    {86, 180, 233}, // sky blue
    {0, 158, 115},  // bluish green
    {240, 228, 66}, // yellow
    {0, 114, 178},  // blue
    {213, 94, 0},   // vermilion
    {204, 121, 167} // reddish purple
}};

/// The colours of an island in one look.
struct IslandColours {
    Colour outside;             // around the walls
    Colour ground, wall;        // inside the walls, and the walls
    Colour label;               // numbers on the ground
    Colour body_low, body_high; // an organism with no health, and one with the greatest health
    Colour body;                // an organism whose health is unknown
    Colour arc;                 // the health arc; classic: the circle of an organism
    Colour predator_low, predator_high, predator_edge;
    Colour pointed_at, selected; // rings around organisms
    Colour food, poison, crate, crate_edge, obstacle;
    Colour food_radius, poison_radius, trail, death;
    Colour wanders, seeks, flees; // the choice of an organism
};
const IslandColours& of(Look look);

// Colours of the choices on a light background.
constexpr Colour wanders{90, 90, 96};
constexpr Colour seeks = kinds[4];
constexpr Colour flees = kinds[5];

constexpr Colour plot_background{252, 252, 253};
constexpr Colour series_orange = kinds[0];
constexpr Colour series_blue = kinds[4];

} // namespace palette
} // namespace evod::viewer
