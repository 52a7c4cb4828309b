// Shape shaders: the texts of client/shaders, which the page draws with, too. CMake writes the source from them.
//
// Owner        none: constants.
// Threads      any.
#pragma once

namespace evod::viewer {

extern const char* const shape_vertex_source;
extern const char* const shape_fragment_source;

} // namespace evod::viewer
