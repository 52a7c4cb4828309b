// OrganismPanel: shows the selected organism: its parents, its health, choices and offspring, and its genes within the
// range of its generation. Without a selection, it offers the healthiest organisms.
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
    void build_freeze(Context& context, const OrganismHistory& history);
    void build_choice(Context& context);
    void build_life(Context& context, const OrganismHistory& history);
    bool build_brain_of(const Context& context, const evod::v1::OrganismInfo& info);
    void build_parents(Context& context, const OrganismHistory& history);
    void build_parent(Context& context, const OrganismHistory& history, std::uint32_t parent);
    void build_genes(Context& context, const OrganismHistory& history);
    void build_offspring(const OrganismHistory& history);
};

/// Returns the organism's fate as text: "died of hunger after 12.3 s", "alive when last seen after 40.0 s; its
/// generation has ended", "alive for 12.3 s, …".
std::string shown_fate(const OrganismHistory& history);
/// Returns the organism's choice as text: "about to seek food at (120, 40)".
std::string shown_choice(const evod::v1::OrganismInfo& info);
/// Returns the parents as text: "Parents: 12 and 45 (generation 35)". A survivor has one parent.
std::string shown_parents(const evod::v1::OrganismInfo& info, OrganismHistory::Origin origin);
/// Returns the children as text: "3 (unchanged), 7 (with 12), 9 (single parent)"; "none" if there are no children.
std::string shown_children(const std::vector<OrganismHistory::Child>& children);

} // namespace evod::viewer
