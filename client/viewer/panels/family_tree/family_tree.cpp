#include "client/viewer/panels/family_tree/family_tree.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

namespace evod::viewer {

namespace {

constexpr double fitted_generations_min = 6;

/// Moves the positions in a row as little as possible (least squares), so that they rise by at least 1 from one to the
/// next, and lie at least 0.5 inside 0 to `width`.
///
/// width   at least the number of positions.
/// Source  Pool adjacent violators: Ayer et al. 1955, "An empirical distribution function for sampling with incomplete
///         information", doi:10.1214/aoms/1177728423.
void spread(std::vector<float>& x, float width) {
    struct Block {
        double sum;
        std::size_t count;
        double mean() const { return sum / static_cast<double>(count); }
    };
    std::vector<Block> blocks; // of neighbours at a distance of exactly 1
    for (std::size_t i = 0; i < x.size(); ++i) {
        blocks.push_back({static_cast<double>(x[i]) - static_cast<double>(i), 1});
        while (blocks.size() > 1 && blocks[blocks.size() - 2].mean() >= blocks.back().mean()) {
            const Block last = blocks.back();
            blocks.pop_back();
            blocks.back().sum += last.sum;
            blocks.back().count += last.count;
        }
    }
    const double most = static_cast<double>(width) - static_cast<double>(x.size()) + 0.5;
    std::size_t i = 0;
    for (const Block& block : blocks) {
        for (const std::size_t end = i + block.count; i < end; ++i) {
            x[i] = static_cast<float>(std::clamp(block.mean(), 0.5, most) + static_cast<double>(i));
        }
    }
}

} // namespace

FamilyTree::FamilyTree(const Lineage& lineage, std::uint64_t generation, std::span<const std::uint32_t> roots,
                       Parents parents) {
    if (roots.empty()) {
        return;
    }
    find_ancestors(lineage, generation, roots, parents);
    order();
    if (parents == Parents::First) {
        place_by_descendants();
        find_lines();
    } else {
        place_near_parents();
    }
    find_common_ancestors();
}

void FamilyTree::find_ancestors(const Lineage& lineage, std::uint64_t generation, std::span<const std::uint32_t> roots,
                                Parents parents) {
    rows_.emplace_back();
    for (const std::uint32_t root : roots) {
        rows_.back().push_back({.organism = root});
    }
    std::vector<std::uint32_t> places; // of the organisms in the row above
    for (; generation > lineage.first(); --generation) {
        Row above;
        places.assign(lineage.at(generation - 1).organisms.size(), none);
        const auto place = [&](std::uint32_t organism) {
            if (organism >= places.size()) {
                return none;
            }
            if (places[organism] == none) {
                places[organism] = static_cast<std::uint32_t>(above.size());
                above.push_back({.organism = organism});
            }
            return places[organism];
        };
        for (Spot& spot : rows_.back()) {
            const auto [first, second] = lineage.at(generation).organisms[spot.organism].parents;
            spot.first = place(first);
            if (parents == Parents::Both && second != first) {
                spot.second = place(second);
            }
            if (spot.first != none) {
                ++above[spot.first].child_count;
            }
        }
        if (above.empty()) { // the first generation of the run
            break;
        }
        rows_.push_back(std::move(above));
    }
    first_ = generation;
    std::ranges::reverse(rows_);
}

/// Orders every row, from the earliest one on.
void FamilyTree::order() {
    std::vector<std::uint32_t> order, places; // old places by new place, new places by old place
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        Row& row = rows_[i];
        order.resize(row.size());
        std::iota(order.begin(), order.end(), 0u);
        const auto key = [&](std::uint32_t place) {
            const Spot& spot = row[place];
            return std::tuple{spot.first, spot.second, spot.organism};
        };
        std::ranges::sort(order, {}, key);
        Row ordered;
        ordered.reserve(row.size());
        places.resize(row.size());
        for (const std::uint32_t place : order) {
            places[place] = static_cast<std::uint32_t>(ordered.size());
            ordered.push_back(row[place]);
        }
        row = std::move(ordered);
        if (i + 1 < rows_.size()) {
            for (Spot& child : rows_[i + 1]) {
                child.first = child.first == none ? none : places[child.first];
                child.second = child.second == none ? none : places[child.second];
            }
        }
    }
}

/// Places the roots at equal distances, and every other organism in the middle above its children.
void FamilyTree::place_by_descendants() {
    width_ = static_cast<float>(rows_.back().size());
    for (std::size_t i = 0; i < rows_.back().size(); ++i) {
        rows_.back()[i].x = static_cast<float>(i) + 0.5f;
    }
    for (std::size_t i = rows_.size() - 1; i > 0; --i) {
        Row& above = rows_[i - 1];
        for (std::size_t child = 0; child < rows_[i].size();) { // children of an organism are adjacent
            const std::uint32_t parent = rows_[i][child].first;
            const float left = rows_[i][child].x;
            float right = left;
            for (; child < rows_[i].size() && rows_[i][child].first == parent; ++child) {
                right = rows_[i][child].x;
            }
            if (parent != none) {
                above[parent].x = (left + right) / 2;
            }
        }
    }
}

/// Places every organism near its first parent and its children, at a distance of at least 1 from its neighbours.
void FamilyTree::place_near_parents() {
    std::size_t most = 0;
    for (const Row& row : rows_) {
        most = std::max(most, row.size());
    }
    width_ = static_cast<float>(most);
    for (Row& row : rows_) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            row[i].x = (static_cast<float>(i) + 0.5f) / static_cast<float>(row.size()) * width_;
        }
    }
    std::vector<float> wanted, of_children;
    const auto place = [&](std::size_t i) {
        Row& row = rows_[i];
        wanted.clear();
        for (const Spot& spot : row) {
            wanted.push_back(spot.first == none ? spot.x : rows_[i - 1][spot.first].x);
        }
        if (i + 1 < rows_.size()) { // the mean of the children counts as much as the parent
            of_children.assign(row.size(), 0);
            for (const Spot& child : rows_[i + 1]) {
                if (child.first != none) {
                    of_children[child.first] += child.x / static_cast<float>(row[child.first].child_count);
                }
            }
            for (std::size_t j = 0; j < row.size(); ++j) {
                wanted[j] = row[j].child_count == 0 ? wanted[j] : (wanted[j] + of_children[j]) / 2;
            }
        }
        spread(wanted, width_);
        for (std::size_t j = 0; j < row.size(); ++j) {
            row[j].x = wanted[j];
        }
    };
    constexpr int pass_count = 6;
    for (int pass = 0; pass < pass_count; ++pass) {
        for (std::size_t i = rows_.size(); i-- > 0;) {
            place(i);
        }
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            place(i);
        }
    }
}

void FamilyTree::find_lines() {
    struct Top {
        std::uint64_t generation;
        std::uint32_t place;
    };
    std::vector<Top> above, tops; // for each organism of a row, where the line to it begins
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        tops.clear();
        for (std::uint32_t place = 0; place < rows_[i].size(); ++place) {
            const Spot& spot = rows_[i][place];
            const Top own{first_ + i, place};
            const Top top = spot.first == none                         ? own
                            : rows_[i - 1][spot.first].child_count > 1 ? Top{first_ + i - 1, spot.first}
                                                                       : above[spot.first];
            tops.push_back(top);
            if (spot.child_count != 1 && top.generation != own.generation) {
                lines_.push_back({top.generation, own.generation, top.place, place});
            }
        }
        std::swap(above, tops);
    }
}

/// Finds, row by row from the roots upwards, which roots descend from each organism.
void FamilyTree::find_common_ancestors() {
    const std::size_t root_count = rows_.back().size(), words = (root_count + 63) / 64;
    if (root_count < 2) {
        return;
    }
    std::vector<std::uint64_t> below(root_count * words), above; // `words` per organism, one bit per root
    for (std::size_t root = 0; root < root_count; ++root) {
        below[root * words + root / 64] |= std::uint64_t{1} << (root % 64);
    }
    for (std::size_t i = rows_.size() - 1; i > 0; --i) {
        above.assign(rows_[i - 1].size() * words, 0);
        for (std::size_t child = 0; child < rows_[i].size(); ++child) {
            for (const std::uint32_t parent : {rows_[i][child].first, rows_[i][child].second}) {
                for (std::size_t word = 0; parent != none && word < words; ++word) {
                    above[parent * words + word] |= below[child * words + word];
                }
            }
        }
        std::vector<std::uint32_t> common;
        for (std::uint32_t place = 0; place < rows_[i - 1].size(); ++place) {
            std::size_t count = 0;
            for (std::size_t word = 0; word < words; ++word) {
                count += static_cast<std::size_t>(__builtin_popcountll(above[place * words + word]));
            }
            if (count == root_count) {
                common.push_back(place);
            }
        }
        const bool all = common.size() == rows_[i - 1].size();
        if (!common.empty() && !common_generation_) {
            common_generation_ = first_ + i - 1;
            common_ancestors_ = std::move(common);
        }
        if (all) {
            all_common_generation_ = first_ + i - 1;
            return;
        }
        std::swap(below, above);
    }
}

std::size_t FamilyTree::placed_count() const {
    std::size_t count = 0;
    for (std::size_t i = 1; i < rows_.size(); ++i) {
        count += static_cast<std::size_t>(std::ranges::count(rows_[i], none, &Spot::first));
    }
    return count;
}

std::uint32_t FamilyTree::place_of(std::uint64_t generation, std::uint32_t organism) const {
    if (!contains(generation)) {
        return none;
    }
    const auto found = std::ranges::find(row(generation), organism, &Spot::organism);
    return found == row(generation).end() ? none : static_cast<std::uint32_t>(found - row(generation).begin());
}

void FamilyTree::set_base(std::uint64_t generation) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        for (Spot& spot : rows_[i]) {
            spot.founder = first_ + i == generation                        ? spot.organism
                           : first_ + i < generation || spot.first == none ? none
                                                                           : rows_[i - 1][spot.first].founder;
        }
    }
}

Range whole_generations(const FamilyTree& tree) {
    const double first = static_cast<double>(tree.first()), last = static_cast<double>(tree.last());
    return {std::min(first, last - fitted_generations_min) - 0.5, last + 0.5};
}

Range fitted_generations(const FamilyTree& tree) {
    const Range whole = whole_generations(tree);
    const auto& common = tree.all_common_generation() ? tree.all_common_generation() : tree.common_generation();
    if (!common) {
        return whole;
    }
    const double depth = static_cast<double>(tree.last() - *common);
    const double top = static_cast<double>(*common) - std::max(1.5, 0.2 * depth);
    return {std::clamp(std::min(top, whole.max - fitted_generations_min), whole.min, whole.max), whole.max};
}

} // namespace evod::viewer
