#include "client/viewer/island/styles.h"

namespace evod::viewer {

namespace {

constexpr Colour transparent{0, 0, 0, 0};

/// The styles that both skins share, in the colours of a look.
Styles common(const palette::IslandColours& of) {
    Styles styles{};
    styles.selected = {.fill = transparent, .edge = of.selected, .edge_pixels = 3, .half_pixels_min = 6};
    styles.heading = {.form = Form::Line, .fill = of.label, .line_pixels = 2};
    styles.crate = {
        .form = Form::Rectangle, .fill = of.crate, .edge = of.crate_edge, .edge_pixels = 2, .half_pixels_min = 1};
    styles.obstacle = {.form = Form::Rectangle, .fill = of.obstacle, .half_pixels_min = 1};
    styles.food_radius = {.fill = transparent, .edge = of.food_radius, .edge_pixels = 1};
    styles.poison_radius = {.fill = transparent, .edge = of.poison_radius, .edge_pixels = 1};
    styles.arrow = {.form = Form::Arrow, .line_pixels = 2};
    styles.target = {.form = Form::Line, .line_pixels = 1};
    styles.food_dot = {.fill = of.food, .half_pixels_min = 0.5f};
    styles.poison_dot = {.fill = of.poison, .half_pixels_min = 0.5f};
    styles.food_dot.fill.alpha = styles.poison_dot.fill.alpha = 140;
    styles.ripple = {.form = Form::Ripple};
    return styles;
}

Styles vivid(const palette::IslandColours& of, std::uint8_t shadow) {
    Styles styles = common(of);
    styles.organism = {.form = Form::Body,
                       .fill = of.body_high,
                       .edge = of.arc,
                       .fill_low = of.body_low,
                       .edge_pixels = 3,
                       .half_pixels_min = 1.5f};
    styles.coloured = styles.organism;
    styles.predator = {.form = Form::Triangle,
                       .fill = of.predator_high,
                       .edge = of.predator_edge,
                       .fill_low = of.predator_low,
                       .edge_pixels = 1,
                       .half_pixels_min = 1.5f};
    styles.organism_dot = {.fill = of.body, .half_pixels_min = 1.1f};
    styles.pointed_at = {.fill = transparent, .edge = of.pointed_at, .edge_pixels = 2, .half_pixels_min = 5};
    styles.food = {.form = Form::Leaf, .fill = of.food, .half_pixels_min = 0.75f};
    styles.poison = {.form = Form::Star, .fill = of.poison, .half_pixels_min = 0.75f};
    styles.trail = {.form = Form::SoftLine, .fill = of.trail, .line_pixels = 5};
    styles.shadow = {.form = Form::SoftLine, .fill = {0, 0, 0, shadow}, .line_pixels = 48};
    styles.highlight_pixels = 8;
    styles.heading_pixels = 10;
    styles.label_zoom_min = 1.4f;
    return styles;
}

Styles classic(const palette::IslandColours& of) {
    Styles styles = common(of);
    styles.organism = {.fill = transparent, .edge = of.body, .edge_pixels = 2, .half_pixels_min = 1.5f};
    styles.coloured = {.edge = palette::organism_outline, .edge_pixels = 1, .half_pixels_min = 1.5f};
    styles.predator = {.form = Form::Triangle,
                       .fill = transparent,
                       .edge = of.predator_edge,
                       .fill_low = transparent,
                       .edge_pixels = 2,
                       .half_pixels_min = 1.5f};
    styles.organism_dot = styles.organism;
    styles.pointed_at = {.fill = {255, 255, 255, 90}, .edge = of.pointed_at, .edge_pixels = 3, .half_pixels_min = 4};
    styles.food = {.fill = of.food, .half_pixels_min = 1};
    styles.poison = {.fill = of.poison, .half_pixels_min = 1};
    styles.trail = {.form = Form::Line, .fill = of.trail, .line_pixels = 1.5f};
    styles.shadow = {.form = Form::SoftLine, .fill = transparent};
    styles.highlight_pixels = 0;
    styles.heading_pixels = 6;
    styles.label_zoom_min = 0.45f;
    return styles;
}

} // namespace

const Styles& styles_of(Look look) {
    static const Styles dark = vivid(palette::of({Skin::Vivid, Background::Dark}), 110);
    static const Styles light = vivid(palette::of({Skin::Vivid, Background::Light}), 60);
    static const Styles grey = classic(palette::of({Skin::Classic, Background::Light}));
    return look.skin == Skin::Classic ? grey : look.background == Background::Light ? light : dark;
}

} // namespace evod::viewer
