// Tree drawing: draws a family tree, with generations from top to bottom, and finds the organism at the mouse.
//
// It draws only what is visible, at most `lines_max` lines. If a pedigree has more visible lines, it first leaves out
// the lines to second parents, then draws lines of first parents that span several generations.
//
// Owner        FamilyTreePanel; a TreeDrawing lives for one frame.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/drawing/ink.h"
#include "client/viewer/island/marks.h"
#include "client/viewer/panels/family_tree/family_tree.h"

#include <optional>
#include <string>

namespace evod::viewer {

/// An organism of a run.
struct RunOrganism {
    std::uint64_t generation = 0;
    std::uint32_t index = 0; // in its generation, as in Lineage
    friend bool operator==(const RunOrganism&, const RunOrganism&) = default;
};

/// Returns the colour of a lineage as thin lines show it on the light background: yellow is darker.
Colour on_paper(Colour colour);

/// Draws the mark of an organism whose first parent lived on another island.
void draw_migrant_mark(ImDrawList& list, ImVec2 at, float pixel);

class TreeDrawing {
  public:
    static constexpr std::size_t lines_max = 12'000;

    struct Subject {
        const FamilyTree& tree;
        const Lineage& lineage;
        const FamilyColours& colours; // of the founders in the generation `since`
        std::uint64_t since = 1;
        bool both_parents = false;                  // a pedigree
        std::optional<RunOrganism> selected = {};   // its line of first parents is highlighted
        std::optional<std::uint64_t> replayed = {}; // the generation that a replay shows
    };
    struct View {
        Range x, generations;
    };

    /// corner, end  of the drawing with its labels, in pixels
    TreeDrawing(ImDrawList& list, ImFont& font, float pixel, ImVec2 corner, ImVec2 end, const Subject& subject,
                const View& view);

    void draw();
    /// Returns the organism of the tree at this point.
    std::optional<RunOrganism> at(ImVec2 point) const;
    /// Highlights an organism and the lines to its parents.
    void draw_pointed_at(const RunOrganism& organism);
    /// Returns the position of an organism of the tree.
    ImVec2 point(std::uint64_t generation, std::uint32_t place) const;
    /// Whether the point is inside the drawing, without its labels.
    bool shows(ImVec2 point) const;

    ImVec2 corner() const { return corner_; } // of the drawing without the labels
    ImVec2 end() const { return end_; }
    /// Whether the lines to second parents were left out because too many are visible.
    bool second_parents_left_out() const { return second_left_out_; }

  private:
    float column(double x) const;
    float row(double generation) const;
    void draw_generations();
    void draw_lines();
    void draw_pedigree();
    void draw_line_to(ImVec2 parent, ImVec2 child, Colour colour, float thickness);
    void draw_selected();
    void draw_migrants();
    void draw_marks();
    Colour colour_of(std::uint64_t generation, std::uint32_t place) const;

    ImDrawList& list_;
    ImFont& font_;
    float pixel_;
    ImVec2 corner_, end_;
    const Subject& subject_;
    View view_;
    bool second_left_out_ = false;
};

} // namespace evod::viewer
