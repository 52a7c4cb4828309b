// Colours with a meaning differ for every kind of colour vision: simulates each kind of colour blindness and measures
// the differences in CIE L*a*b*.
//
// Source   Machado, Oliveira & Fernandes 2009, IEEE Trans. Vis. Comput. Graph. 15(6), doi:10.1109/TVCG.2009.113, the
//          matrices of severity 1; CIE 1976 L*a*b* with the white of sRGB, D65.
#include "client/viewer/drawing/palette.h"

#include "client/viewer/drawing/colour_scale.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace evod::viewer::palette {
namespace {

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;

struct Vision {
    const char* name;
    Matrix seen; // of linear red, green, blue
};
constexpr Vision visions[] = {
    {"all cones", {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}},
    {"protanopia",
     {{{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}}},
    {"deuteranopia",
     {{{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}}},
    {"tritanopia",
     {{{1.255528, -0.076749, -0.178779}, {-0.078411, 0.930809, 0.147602}, {0.004733, 0.691367, 0.303900}}}},
};

Vector times(const Matrix& matrix, const Vector& vector) {
    Vector product{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            product[i] += matrix[i][j] * vector[j];
        }
    }
    return product;
}

double linear(std::uint8_t value) {
    const double share = value / 255.0;
    return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
}

Vector lab(Colour colour, const Vision& vision) {
    const Vector seen = times(vision.seen, {linear(colour.red), linear(colour.green), linear(colour.blue)});
    const Matrix to_xyz{
        {{0.4124564, 0.3575761, 0.1804375}, {0.2126729, 0.7151522, 0.0721750}, {0.0193339, 0.1191920, 0.9503041}}};
    const Vector xyz = times(to_xyz, seen);
    constexpr Vector white{0.95047, 1, 1.08883};
    Vector f;
    for (std::size_t i = 0; i < 3; ++i) {
        const double share = std::max(xyz[i], 0.0) / white[i];
        f[i] = share > 216.0 / 24389 ? std::cbrt(share) : (24389.0 / 27 * share + 16) / 116;
    }
    return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

double difference(Colour a, Colour b, const Vision& vision) {
    const Vector one = lab(a, vision), other = lab(b, vision);
    return std::hypot(one[0] - other[0], one[1] - other[1], one[2] - other[2]);
}

// 2.3 is just noticeable side by side; discs of a few pixels, apart from each other, need several times that.
constexpr double needed = 12;

TEST(Palette, KindsDifferForEveryColourVision) {
    for (const Vision& vision : visions) {
        for (std::size_t i = 0; i < kinds.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                EXPECT_GT(difference(kinds[i], kinds[j], vision), needed) << vision.name << ": " << i << " and " << j;
            }
            EXPECT_GT(difference(kinds[i], background, vision), needed) << vision.name << ": " << i << " on the ground";
        }
    }
}

/// A translucent colour over a ground.
Colour on(Colour ground, Colour colour) {
    const auto mix = [&](std::uint8_t above, std::uint8_t below) {
        return static_cast<std::uint8_t>(std::lround(below + (above - below) * (colour.alpha / 255.0)));
    };
    return {mix(colour.red, ground.red), mix(colour.green, ground.green), mix(colour.blue, ground.blue)};
}

constexpr Look looks[] = {{Skin::Vivid, Background::Dark}, {Skin::Vivid, Background::Light}, {Skin::Classic}};

std::string name_of(Look look, const Vision& vision) {
    return std::string{skin_names[static_cast<std::size_t>(look.skin)]} + " " +
           std::string{background_names[static_cast<std::size_t>(look.background)]} + " as seen with " + vision.name;
}

TEST(Palette, EachLookIsClearForEveryColourVision) {
    for (const Look look : looks) {
        const IslandColours& colours = of(look);
        // Vivid marks differ more than the colours of the first version.
        const double clear = look.skin == Skin::Vivid ? 20 : 15;
        for (const Vision& vision : visions) {
            SCOPED_TRACE(name_of(look, vision));
            EXPECT_GT(difference(colours.food, colours.poison, vision), clear);
            EXPECT_GT(difference(colours.food, colours.ground, vision), clear);
            EXPECT_GT(difference(colours.poison, colours.ground, vision), clear);
            for (const Colour organism : {colours.body_low, colours.body, colours.body_high}) {
                EXPECT_GT(difference(organism, colours.food, vision), clear);
                EXPECT_GT(difference(organism, colours.poison, vision), clear);
                EXPECT_GT(difference(organism, colours.ground, vision), clear);
            }
            EXPECT_GT(difference(colours.wall, colours.ground, vision), clear);
            EXPECT_GT(difference(colours.crate, colours.ground, vision), clear);
            EXPECT_GT(difference(colours.obstacle, colours.ground, vision), clear);
            EXPECT_GT(difference(colours.label, colours.ground, vision), 3 * clear);
            EXPECT_GT(difference(colours.pointed_at, colours.ground, vision), clear);
            EXPECT_GT(difference(colours.seeks, colours.flees, vision), clear);
            EXPECT_GT(difference(colours.wanders, colours.ground, vision), clear);
            const Colour food_ring = on(colours.ground, colours.food_radius),
                         poison_ring = on(colours.ground, colours.poison_radius);
            EXPECT_GT(difference(food_ring, poison_ring, vision), needed);
            EXPECT_GT(difference(food_ring, colours.ground, vision), needed);
            EXPECT_GT(difference(poison_ring, colours.ground, vision), needed);
            EXPECT_GT(difference(poison_ring, colours.body, vision), needed);
        }
    }
}

TEST(Palette, VioletIsNeverConfusedWithFoodOrPoison) {
    for (const Look look : looks) {
        for (const Vision& vision : visions) {
            for (int i = 0; i <= 40; ++i) {
                const Colour colour = at(Ramp::Violet, i / 40.0);
                EXPECT_GT(difference(colour, of(look).food, vision), 30) << name_of(look, vision) << " at " << i;
                EXPECT_GT(difference(colour, of(look).poison, vision), 30) << name_of(look, vision) << " at " << i;
                if (look.skin == Skin::Vivid) { // classic draws an outline
                    EXPECT_GT(difference(colour, of(look).ground, vision), needed) << name_of(look, vision) << " " << i;
                }
            }
        }
    }
}

TEST(Palette, CurvesDifferForEveryColourVision) {
    for (const Vision& vision : visions) {
        EXPECT_GT(difference(series_orange, series_blue, vision), needed) << vision.name;
        EXPECT_GT(difference(series_orange, plot_background, vision), needed) << vision.name;
        EXPECT_GT(difference(series_blue, plot_background, vision), needed) << vision.name;
    }
}

TEST(Palette, RampsGetLighterForEveryColourVision) {
    for (const Vision& vision : visions) {
        for (const Ramp ramp : ramps) {
            double before = -1;
            for (int i = 0; i <= 20; ++i) {
                const double lightness = lab(at(ramp, i / 20.0), vision)[0];
                EXPECT_GT(lightness, before) << name_of(ramp) << " as seen with " << vision.name << " at " << i;
                before = lightness;
            }
            EXPECT_GT(difference(at(ramp, 0), at(ramp, 1), vision), 50) << name_of(ramp) << " " << vision.name;
            for (int i = 0; i < 8; ++i) { // an eighth of the range is visible
                EXPECT_GT(difference(at(ramp, i / 8.0), at(ramp, (i + 1) / 8.0), vision), 5)
                    << name_of(ramp) << " as seen with " << vision.name << " at " << i;
            }
        }
    }
}

TEST(ColourScale, MapsItsRangeAndClampsBeyondIt) {
    const ColourScale scale{Ramp::Viridis, 10, 20};
    EXPECT_EQ(scale(10), at(Ramp::Viridis, 0));
    EXPECT_EQ(scale(15), at(Ramp::Viridis, 0.5));
    EXPECT_EQ(scale(99), at(Ramp::Viridis, 1));
    EXPECT_EQ((ColourScale{Ramp::Viridis, 3, 3}(3)), at(Ramp::Viridis, 0.5)) << "an empty range";
}

TEST(Palette, RampsEndWithTheColoursOfTheirSource) {
    EXPECT_EQ(at(Ramp::Viridis, 0), (Colour{68, 1, 84}));
    EXPECT_EQ(at(Ramp::Viridis, 1), (Colour{253, 231, 37}));
    EXPECT_EQ(at(Ramp::Cividis, 0), (Colour{0, 34, 78}));
    EXPECT_EQ(at(Ramp::Cividis, 1), (Colour{254, 232, 56}));
    // 120 of 255 is one of the stored stops.
    EXPECT_EQ(at(Ramp::Viridis, 120.0 / 255), (Colour{35, 137, 142}));
    EXPECT_EQ(at(Ramp::Viridis, -3), at(Ramp::Viridis, 0));
    EXPECT_EQ(at(Ramp::Viridis, 7), at(Ramp::Viridis, 1));
    EXPECT_EQ(at(Ramp::Viridis, std::numeric_limits<double>::quiet_NaN()), unknown);
}

} // namespace
} // namespace evod::viewer::palette
