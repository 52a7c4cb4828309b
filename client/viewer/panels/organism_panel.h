// OrganismPanel: shows the selected organism: its health and choice, and its genes within the range of its generation.
// Without a selection, it offers the healthiest organisms.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/panels/panel.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace evod::viewer {

class OrganismPanel : public Panel {
  public:
    static constexpr std::string_view name = "Organism";
    std::string_view title() const override { return name; }
    void build(Context& context) override;

  private:
    void build_choice(Context& context);
    void build_life(Context& context, const SelectedOrganism& organism);
    void build_genes(Context& context, const SelectedOrganism& organism);
};

/// Returns the organism's fate as text: "died of hunger after 12.3 s", "alive when last seen after 40.0 s; its
/// generation has ended", "alive for 12.3 s, …".
std::string shown_fate(const SelectedOrganism& organism);
/// Returns the organism's choice as text: "about to seek food at (120, 40)".
std::string shown_choice(const evod::v1::OrganismInfo& info);

} // namespace evod::viewer
