// FreezerPanel: lists the frozen organisms and populations, stores the population of the viewed world, and places them
// in worlds.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/panels/panel.h"
#include "client/viewer/world/whole_population.h"

#include <optional>
#include <string>

namespace evod::viewer {

class FreezerPanel : public Panel {
  public:
    static constexpr std::string_view name = "Freezer";
    std::string_view title() const override { return name; }
    void build(Context& context) override;

  private:
    void build_freeze(Context& context);
    void build_files(Context& context);
    void build_actions(Context& context);

    WholePopulation population_;
    std::string name_;    // typed for the next file; empty: chosen from the world and its generation
    std::string chosen_;  // name of the chosen file
    std::string problem_; // why the last action failed; empty: it succeeded
    std::optional<core::Result<WholePopulation::Genes>> read_; // genes to store in the next frame
};

} // namespace evod::viewer
