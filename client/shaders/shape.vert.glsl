// Shapes, vertex stage: places circles, rectangles, lines and arrows, one triangle or point each.
//
// evoview (client/viewer/island/shapes.cpp) and the page (client/web/src/render/shaders.ts) embed this text. Each puts before
// it: the version, the precision, a number for each form (CIRCLE ...), FORM, POINT and BARE; and after it: read_source(), which
// reads a shape from the tables of that program.
uniform bool coloured;               // whether each shape has its own colour
uniform vec2 pixel_size;             // size of one pixel in clip space
uniform vec2 origin;                 // of the camera's centre, in pixels
uniform float half_pixels_min, line_pixels, edge_pixels;
uniform vec4 fill, fill_low;
#if POINT
flat out float reach;                // half the size of the point, in pixels
#else
out vec2 place;                      // offset from the shape's centre, in pixels, along the shape's axes
#endif
flat out vec2 half_size;
flat out vec4 own_fill;
#if FORM == BODY && !BARE
flat out vec3 arc;                   // of a body: direction across the end of the arc; health
flat out float rim;                  // of a body: width of the arc; 0: none
#endif
struct Source {
    vec2 middle;                     // centre of the shape; of lines and arrows: begin. From the camera's centre, in pixels
    vec2 extent;                     // half size; of lines and arrows: from begin to end. In pixels
    float health;                    // of a body or triangle, 0 to 1
    vec4 colour;                     // read if `coloured`
};
Source read_source(int index);
void main() {
    Source source = read_source(POINT == 1 ? gl_VertexID : gl_VertexID / 3);
    vec2 middle = source.middle, along = vec2(1.0, 0.0), around = vec2(0.5);
    half_size = max(source.extent, vec2(half_pixels_min));
    own_fill = coloured ? source.colour : fill;
#if FORM == LINE || FORM == ARROW || FORM == SOFT_LINE
    float pixels = length(source.extent);
    middle += source.extent / 2.0;
    along = pixels > 0.0 ? source.extent / pixels : along;
    half_size = vec2(pixels, line_pixels) / 2.0;
    around += FORM == ARROW ? vec2(line_pixels, 2.5 * line_pixels) : vec2(line_pixels);
#elif FORM == BODY
    half_size = half_size.xx;
#if !BARE
    rim = half_size.x < 0.8 * edge_pixels ? 0.0 : min(edge_pixels, 0.4 * half_size.x); // a small body has no arc
    around += 1.6 * rim;
    arc = vec3(cos(6.2831853 * source.health), sin(6.2831853 * source.health), source.health);
#endif
    own_fill = coloured ? own_fill : mix(fill_low, fill, source.health);
#elif FORM == LEAF || FORM == STAR || FORM == TRIANGLE
#if FORM == TRIANGLE
    half_size = half_size.xx;
    own_fill = coloured ? own_fill : mix(fill_low, fill, source.health);
#endif
    around += 0.5 + 0.5 * half_size;
#elif FORM == CIRCLE
    half_size = half_size.xx;
#endif
#if POINT
    bool is_dot = half_size.x <= 0.5; // fills the pixel at its centre
    reach = is_dot ? 0.5 : half_size.x + around.x;
    gl_PointSize = 2.0 * reach;
    vec2 pixel = is_dot ? floor(origin + middle) + 0.5 : origin + middle;
#else
    int corner_index = gl_VertexID % 3; // one triangle covers the rectangle around the shape
    vec2 corner = vec2(corner_index == 1, corner_index == 2) * 4.0 - 1.0;
    place = corner * (half_size + around);
    vec2 pixel = origin + middle + along * place.x + vec2(-along.y, along.x) * place.y;
#endif
    gl_Position = vec4(pixel.x * pixel_size.x - 1.0, 1.0 - pixel.y * pixel_size.y, 0.0, 1.0);
}
