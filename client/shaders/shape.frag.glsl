// Shapes, fragment stage: computes how much of a pixel a shape covers from the distance between the pixel's centre and the outline, so
// shapes are smooth at any zoom. Embedded like shape.vert.glsl.
#if POINT
flat in float reach;
#define place ((2.0 * gl_PointCoord - 1.0) * reach)
#else
in vec2 place;
#endif
flat in vec2 half_size;
flat in vec4 own_fill;
#if FORM == BODY && !BARE
flat in vec3 arc;
flat in float rim;
#endif
uniform vec4 edge;
uniform float edge_pixels, line_pixels;
out vec4 colour;                     // with premultiplied alpha
float covered(float outside) {
    return clamp(0.5 - outside, 0.0, 1.0);
}
#if FORM == BODY && BARE
void main() {
    float from_centre = length(place), share = from_centre / half_size.x;
    colour = vec4(own_fill.rgb * (1.0 - 0.2 * share * share), 1.0) * own_fill.a * covered(from_centre - half_size.x);
}
#elif FORM == BODY
void main() {
    float radius = half_size.x, from_centre = length(place);
    float outer = radius + 1.6 * rim, share = from_centre / radius;
    float before_end = -dot(place, arc.xy), after_begin = place.x;
    float within = arc.z < 0.5 ? min(after_begin, before_end) : max(after_begin, before_end);
    float lit = arc.z <= 0.0 ? 0.0 : arc.z >= 1.0 ? 1.0 : clamp(within + 0.5, 0.0, 1.0);
    float ring = covered(from_centre - outer) - covered(from_centre - outer + rim);
    colour = vec4(own_fill.rgb * (1.0 - 0.2 * share * share), 1.0) * own_fill.a * covered(from_centre - radius) +
             vec4(edge.rgb, 1.0) * edge.a * ring * (0.2 + 0.8 * lit);
}
#elif FORM == RIPPLE
void main() {
    float share = length(place) / half_size.x;
    colour = vec4(own_fill.rgb, 1.0) * own_fill.a * share * share * covered(length(place) - half_size.x);
}
#elif FORM == SOFT_LINE
void main() {
    float across = clamp(1.0 - abs(place.y) / half_size.y, 0.0, 1.0);
    colour = vec4(own_fill.rgb, 1.0) * own_fill.a * across * covered(abs(place.x) - half_size.x);
}
#else
float distance_outside() {
    vec2 beyond = abs(place) - half_size;
#if FORM == CIRCLE
    return length(place) - half_size.x;
#elif FORM == RECTANGLE
    return max(beyond.x, beyond.y);
#elif FORM == LEAF                   // the overlap of two discs
    vec2 tilted = vec2(place.x - place.y, place.x + place.y) * 0.7071;
    return length(vec2(tilted.x, abs(tilted.y) + 1.018 * half_size.x)) - 2.068 * half_size.x;
#elif FORM == STAR                   // the distance from the line between a tip and the valley next to it
    vec2 tilted = abs(vec2(place.x - place.y, place.x + place.y)) * 0.7071;
    tilted = tilted.y > tilted.x ? tilted.yx : tilted;
    return dot(tilted - vec2(2.0 * half_size.x, 0.0), vec2(0.339, 0.941));
#elif FORM == TRIANGLE               // upright; its tips are 1.5 radii from its centre
    return max(place.y, 0.866 * abs(place.x) - 0.5 * place.y) - 0.75 * half_size.x;
#else
    float outside = length(vec2(max(beyond.x, 0.0), place.y)) - half_size.y;
#if FORM == ARROW
    float head = min(4.5 * line_pixels, half_size.x), behind_tip = half_size.x - place.x;
    outside = min(outside, max((abs(place.y) - behind_tip / 2.0) * 0.894, behind_tip - head));
#endif
    return outside;
#endif
}
void main() {
    float outside = distance_outside();
    float whole = covered(outside), inner = covered(outside + edge_pixels);
    vec3 inside = own_fill.rgb;
#if FORM == LEAF
    float vein = 0.09 * half_size.x;
    inside *= 1.0 - 0.35 * covered(abs(place.x + place.y) * 0.7071 - vein) * clamp(vein - 0.3, 0.0, 1.0);
#endif
    colour = vec4(edge.rgb, 1.0) * edge.a * (whole - inner) + vec4(inside, 1.0) * own_fill.a * inner;
}
#endif
