// FamilyTree: the ancestors of some organisms of one generation, the roots of the search, with positions for a drawing.
//
// Organisms without a descendant among these are left out: their lines are extinct. There are two kinds of tree:
//
//   Parents::First  only first parents, each of which gave its child at least half of the genes. Every organism has one
//                   line of ancestors. Lines that meet never part again, so the lines coalesce in one organism, the
//                   common ancestor of the lines (Kingman 1982, "The coalescent", doi:10.1016/0304-4149(82)90011-4).
//                   This is not the genealogy of a gene: a gene may come from the second parent.
//   Parents::Both   the pedigree. A common ancestor is an organism from which all descend, along any parents. The most
//                   recent ones live much later than the ancestor of the lines. Before a certain generation each
//                   organism of the tree is an ancestor of all (Chang 1999, "Recent common ancestors of all present-day
//                   individuals", doi:10.1239/aap/1029955256).
//
// Order        the children of an organism are adjacent, and ordered as their parents, so lines of first parents never
//              cross. Children of the same first parent are ordered by their second parent, then by index.
// Owner        FamilyTreePanel.
// Threads      none.
#pragma once

#include "client/viewer/panels/plots/layout.h"
#include "client/viewer/world/lineage.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace evod::viewer {

class FamilyTree {
  public:
    enum class Parents { First, Both };
    static constexpr std::uint32_t none = Lineage::none;

    /// An organism of the tree.
    struct Spot {
        std::uint32_t organism = 0; // index in its generation
        float x = 0;                // from 0 to width()
        // Places of the parents in the row above; `none` if unknown or, for the second one, if it is not in the tree or
        // is the first parent.
        std::uint32_t first = none, second = none;
        std::uint32_t child_count = 0; // children in the tree of which it is the first parent
        std::uint32_t founder = none;  // its ancestor along first parents in the generation of set_base()
    };
    /// The organisms of one generation, ordered by x.
    using Row = std::vector<Spot>;
    /// A line of first parents without a branch, from the place `from` in the row of an upper generation down to the
    /// place `to` in the row of a lower one.
    struct Line {
        std::uint64_t top = 0, bottom = 0; // generations
        std::uint32_t from = 0, to = 0;
    };

    FamilyTree() = default;
    /// roots  indices in a known generation, in increasing order.
    FamilyTree(const Lineage& lineage, std::uint64_t generation, std::span<const std::uint32_t> roots, Parents parents);

    bool empty() const { return rows_.empty(); }
    std::uint64_t first() const { return first_; } // the earliest generation
    std::uint64_t last() const { return first_ + rows_.size() - 1; }
    bool contains(std::uint64_t generation) const { return !empty() && generation >= first() && generation <= last(); }
    const Row& row(std::uint64_t generation) const { return rows_[generation - first_]; }
    float width() const { return width_; }

    /// Returns the number of organisms in the tree that have no parents although they are not of the earliest
    /// generation: a user placed them.
    std::size_t placed_count() const;

    /// Returns the place of an organism in its row; `none` if the tree does not contain it.
    std::uint32_t place_of(std::uint64_t generation, std::uint32_t organism) const;

    /// Returns the lines of a tree of first parents, by increasing bottom, then from left to right. Lines end at the
    /// roots, and at organisms with several children; each line leads up to the next such organism.
    const std::vector<Line>& lines() const { return lines_; }

    /// Returns the latest generation with a common ancestor of all roots; nullopt if there is none among the known
    /// generations, or only one root.
    std::optional<std::uint64_t> common_generation() const { return common_generation_; }
    /// Returns the places of the common ancestors in that generation. In a tree of first parents there is one.
    const std::vector<std::uint32_t>& common_ancestors() const { return common_ancestors_; }
    /// Returns the latest generation of which all organisms in the tree are ancestors of all roots; nullopt if there is
    /// none among the known generations, or only one root.
    std::optional<std::uint64_t> all_common_generation() const { return all_common_generation_; }

    /// Sets the founder of every organism: its ancestor in this generation.
    void set_base(std::uint64_t generation);

  private:
    void find_ancestors(const Lineage& lineage, std::uint64_t generation, std::span<const std::uint32_t> roots,
                        Parents parents);
    void order();
    void place_by_descendants();
    void place_near_parents();
    void find_lines();
    void find_common_ancestors();

    std::vector<Row> rows_; // from the earliest generation
    std::uint64_t first_ = 1;
    float width_ = 1;
    std::vector<Line> lines_;
    std::optional<std::uint64_t> common_generation_, all_common_generation_;
    std::vector<std::uint32_t> common_ancestors_;
};

/// Returns the generations that are shown until the user zooms: those since the lines have separated, and some before
/// them. In a pedigree, those since the generation whose organisms are ancestors of all.
Range fitted_generations(const FamilyTree& tree);
/// Returns the range to which the user can zoom out.
Range whole_generations(const FamilyTree& tree);

} // namespace evod::viewer
