// Summary: the top of the sidebar. It explains the focused world to a newcomer and controls its run.
//
//   name of the world · what the organisms try to do · what the marks mean · the fitness curve · run controls
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/island/mark_painter.h"
#include "client/viewer/panels/panel.h"
#include "client/viewer/world/experiment.h"
#include "client/viewer/world/fitness_history.h"

#include <optional>
#include <string>

namespace evod::viewer {

class Summary {
  public:
    /// Builds one line: the name of the world that the sidebar is about.
    void build_title(const ViewedWorld& world);
    /// Builds everything below the title.
    ///
    /// complete  false: only the run controls
    void build(Panel::Context& context, bool complete);

  private:
    void build_experiment(Panel::Context& context);
    void build_marks(const Panel::Context& context);
    void build_buttons(Panel::Context& context);
    void build_speed(ViewedWorld& world);

    Experiment experiment_;
    FitnessHistory history_;
    MarkPainter marks_;
    std::optional<double> factor_; // speed shown by the slider while the user drags it
    std::string problem_;          // why the typed speed is refused
};

} // namespace evod::viewer
