#include "client/viewer/drawing/palette.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace evod::viewer::palette {

namespace {

using Stops = std::span<const Colour>;

constexpr std::array<Colour, 4> violet{{{70, 38, 150}, {112, 84, 222}, {160, 138, 250}, {208, 194, 255}}};
constexpr std::array<Colour, 18> viridis{{{68, 1, 84},
                                          {72, 23, 105},
                                          {71, 42, 122},
                                          {67, 61, 132},
                                          {61, 78, 138},
                                          {53, 94, 141},
                                          {46, 109, 142},
                                          {41, 123, 142},
                                          {35, 137, 142},
                                          {31, 151, 139},
                                          {33, 165, 133},
                                          {46, 179, 124},
                                          {70, 192, 111},
                                          {101, 203, 94},
                                          {137, 213, 72},
                                          {176, 221, 47},
                                          {216, 226, 25},
                                          {253, 231, 37}}};
constexpr std::array<Colour, 18> cividis{{{0, 34, 78},
                                          {0, 45, 104},
                                          {22, 55, 112},
                                          {46, 65, 109},
                                          {63, 76, 108},
                                          {78, 86, 108},
                                          {92, 97, 110},
                                          {105, 107, 113},
                                          {118, 118, 118},
                                          {131, 129, 121},
                                          {146, 140, 120},
                                          {160, 152, 117},
                                          {175, 164, 113},
                                          {191, 176, 107},
                                          {207, 189, 98},
                                          {223, 202, 87},
                                          {240, 216, 70},
                                          {254, 232, 56}}};

constexpr IslandColours dark{.outside = {11, 12, 22},
                             .ground = {20, 22, 40},
                             .wall = {74, 80, 116},
                             .label = {232, 232, 244},
                             .body_low = {92, 66, 190},
                             .body_high = {206, 192, 255},
                             .body = {160, 138, 250},
                             .arc = {255, 255, 255},
                             .predator_low = {116, 74, 10},
                             .predator_high = {255, 190, 60},
                             .predator_edge = {255, 236, 200},
                             .pointed_at = {255, 255, 255},
                             .selected = {255, 214, 90},
                             .food = {150, 236, 116},
                             .poison = {240, 52, 44},
                             .crate = {124, 92, 58},
                             .crate_edge = {186, 146, 98},
                             .obstacle = {84, 90, 112},
                             .food_radius = {150, 236, 116, 200},
                             .poison_radius = {240, 72, 64, 220},
                             .trail = {150, 130, 245, 120},
                             .death = {255, 176, 90},
                             .wanders = {196, 198, 212},
                             .seeks = kinds[1],
                             .flees = {255, 140, 50}};
constexpr IslandColours light{.outside = strip,
                              .ground = {250, 250, 253},
                              .wall = {92, 96, 124},
                              .label = {28, 26, 44},
                              .body_low = {186, 170, 240},
                              .body_high = {84, 48, 196},
                              .body = {112, 84, 222},
                              .arc = {52, 22, 130},
                              .predator_low = {232, 196, 140},
                              .predator_high = {190, 104, 0},
                              .predator_edge = {104, 56, 0},
                              .pointed_at = {52, 22, 130},
                              .selected = {224, 130, 0},
                              .food = {92, 192, 88},
                              .poison = {186, 12, 28},
                              .crate = {204, 168, 122},
                              .crate_edge = {132, 98, 56},
                              .obstacle = {150, 154, 168},
                              .food_radius = {62, 150, 60, 220},
                              .poison_radius = {186, 12, 28, 220},
                              .trail = {112, 84, 222, 80},
                              .death = {224, 120, 20},
                              .wanders = wanders,
                              .seeks = seeks,
                              .flees = flees};
constexpr IslandColours classic{.outside = strip,
                                .ground = background,
                                .wall = wall,
                                .label = health,
                                .body_low = organism,
                                .body_high = organism,
                                .body = organism,
                                .arc = organism,
                                .predator_low = predator,
                                .predator_high = predator,
                                .predator_edge = predator,
                                .pointed_at = organism_pointed_at,
                                .selected = selected,
                                .food = food,
                                .poison = poison,
                                .crate = crate,
                                .crate_edge = crate_edge,
                                .obstacle = obstacle,
                                .food_radius = food_radius,
                                .poison_radius = poison_radius,
                                .trail = trail,
                                .death = organism,
                                .wanders = wanders,
                                .seeks = seeks,
                                .flees = flees};

std::uint8_t between(std::uint8_t from, std::uint8_t to, double share) {
    return static_cast<std::uint8_t>(std::lround(from + (to - from) * share));
}

} // namespace

std::string_view name_of(Ramp ramp) {
    return ramp == Ramp::Violet ? "violet" : ramp == Ramp::Viridis ? "viridis" : "cividis";
}

const IslandColours& of(Look look) {
    return look.skin == Skin::Classic ? classic : look.background == Background::Light ? light : dark;
}

Colour at(Ramp ramp, double share) {
    if (std::isnan(share)) {
        return unknown;
    }
    const Stops stops = ramp == Ramp::Violet ? Stops{violet} : ramp == Ramp::Viridis ? Stops{viridis} : Stops{cividis};
    const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
    const auto before = std::min(static_cast<std::size_t>(place), stops.size() - 2);
    const Colour from = stops[before], to = stops[before + 1];
    const double beyond = place - static_cast<double>(before);
    return {between(from.red, to.red, beyond), between(from.green, to.green, beyond),
            between(from.blue, to.blue, beyond)};
}

} // namespace evod::viewer::palette
