// FamilyTreePanel: shows the family tree of the viewed island's newest generation, or of the selected organism. A click
// on an organism opens a replay at its birth.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/panels/family_tree/tree_drawing.h"
#include "client/viewer/panels/panel.h"

#include <optional>
#include <string>

namespace evod::viewer {

class FamilyTreePanel : public Panel {
  public:
    std::string_view title() const override { return "Family tree"; }
    Size first_size() const override { return {640, 620}; }
    void build(Context& context) override;

  private:
    enum class Kind { FirstParents, BothParents, OfSelected };

    /// What the tree is made of. When it changes, the tree is built again.
    struct Source {
        std::uint64_t place = 0, version = 0; // WorldFeed::place_number() and Lineage::version()
        Kind kind = Kind::FirstParents;
        std::optional<RunOrganism> root{}; // of the selected organism's tree
        friend bool operator==(const Source&, const Source&) = default;
    };

    void build_choices(Context& context);
    void update_tree(Context& context);
    void colour_tree(const Context& context);
    void build_drawing(Context& context);
    void move_view(const TreeDrawing& drawing, const TreeDrawing::View& shown);
    void build_legend(const Context& context, bool second_parents_left_out);
    std::string sentence(const Context& context) const;
    std::string note_of(const Context& context, const RunOrganism& organism) const;
    void show_birth(Context& context, const RunOrganism& organism);

    Kind kind_ = Kind::FirstParents;
    Source source_;
    FamilyTree tree_;
    std::uint64_t since_ = 0; // the generation of FamilyTree::set_base()
    FamilyColours colours_;   // of the lineages of the newest generation
    std::optional<RunOrganism> selected_;
    core::SnapshotInterpolator::Clock::time_point next_build_{};
    std::optional<Range> x_, generations_; // the visible part, once the user has changed it
};

} // namespace evod::viewer
