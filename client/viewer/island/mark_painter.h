// MarkPainter: draws marks of an island among widgets, for legends. It uses the styles and the shaders of the island,
// so a legend always matches the island.
//
// Owner        WindowRenderer, Summary.
// Needs        the OpenGL context of the Gui, from the first frame with a mark to destruction.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/island/styles.h"

#include <memory>
#include <optional>

struct ImDrawList;
struct ImVec2;

namespace evod::viewer {

class MarkPainter {
  public:
    MarkPainter();
    ~MarkPainter();
    MarkPainter(MarkPainter&&) noexcept;
    MarkPainter& operator=(MarkPainter&&) noexcept;

    /// Adds a mark of this style to the widgets that are built. Lines and arrows lead from left to right. A body has
    /// three quarters of the greatest health.
    ///
    /// centre  of the mark on the screen, in pixels
    /// radius  of the mark in pixels, with its arc or tips
    /// scale   factor for sizes given in pixels at scale 1
    /// colour  replaces the fill of the style
    void add(ImDrawList& list, ImVec2 centre, float radius, double scale, const ShapeStyle& style,
             std::optional<Colour> colour = {});

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace evod::viewer
