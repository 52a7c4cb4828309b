// OrganismPanel: who is selected: its genes among those of the others, its health, what it does and did, where it comes
// from and who comes of it.
#pragma once

#include "client/viewer/panels/panel.h"

namespace evod::viewer {

class OrganismPanel : public Panel {
  public:
    static constexpr std::string_view name = "Organism";
    std::string_view title() const override { return name; }
    void build(Context& context) override;
};

/// "dead of hunger after 12.3 s", "alive at the end of its generation, after 40.0 s", "alive for 12.3 s".
std::string shown_fate(const OrganismHistory& story);
/// "about to seek food at (120, 40)".
std::string shown_choice(const evod::v1::OrganismInfo& info);
/// "Parents: 12 and 45 (generation 35)"; a survivor has one.
std::string told_parents(const evod::v1::OrganismInfo& info);
/// "3 (as it was), 7 (with 12), 9 (alone)"; "nobody" of none.
std::string shown_children(const std::vector<OrganismHistory::Child>& children);

} // namespace evod::viewer
