#include "client/viewer/panels/breeding/drawing.h"

#include "client/viewer/panels/breeding/family.h"
#include "client/viewer/text/numbers.h"

#include <algorithm>
#include <string>
#include <vector>

namespace evod::viewer {

void draw_descendants(const Sheet& sheet, const BreedingRecord& record, const std::uint32_t* current) {
    const evod::v1::Breeding& breeding = record.breeding();
    const std::uint32_t count = std::max(record.descendant_count(), 1u);
    const float cell = sheet.size.x / static_cast<float>(count), gap = cell > 4 ? 1.f : 0.f;
    const auto cells = [&](std::uint32_t begin, std::uint32_t end, Colour colour) {
        if (gap == 0) {
            sheet.list.AddRectFilled({sheet.corner.x + static_cast<float>(begin) * cell, sheet.corner.y},
                                     {sheet.corner.x + static_cast<float>(end) * cell, sheet.end().y}, ink(colour));
            return;
        }
        for (std::uint32_t i = begin; i < end; ++i) {
            const float left = sheet.corner.x + static_cast<float>(i) * cell;
            sheet.list.AddRectFilled({left, sheet.corner.y}, {left + cell - gap, sheet.end().y}, ink(colour));
        }
    };
    const std::uint32_t elite = std::min(breeding.elite_count(), record.descendant_count());
    const std::uint32_t survivors = std::min(breeding.survivor_count(), record.descendant_count());
    cells(0, elite, palette::glass_elite);
    cells(elite, survivors, palette::glass_survivor);
    cells(survivors, record.descendant_count(), palette::glass_child);
    if (current != nullptr) {
        const float left = sheet.corner.x + static_cast<float>(*current) * cell;
        sheet.list.AddRect({left - 2, sheet.corner.y - 2}, {left + std::max(cell - gap, 2.f) + 2, sheet.end().y + 2},
                           ink(palette::glass_current), 0, 0, 2);
    }
}

float draw_family(const Sheet& sheet, const evod::v1::Descendant& descendant,
                  const std::vector<std::string>& gene_names) {
    const Family family = family_of(descendant);
    const std::size_t count = family.genes.size();
    if (count == 0) {
        return 0;
    }
    const float label_width = std::min(8 * sheet.font.FontSize, sheet.size.x / 4);
    const float cell = (sheet.size.x - label_width) / static_cast<float>(count);
    const float line = sheet.line_height(), bar = line + 6;
    const auto left_of = [&](std::size_t gene) {
        return sheet.corner.x + label_width + static_cast<float>(gene) * cell;
    };
    const auto middle_of = [&](std::size_t gene) { return left_of(gene) + cell / 2; };
    float y = sheet.corner.y;
    const auto label = [&](const std::string& text) { sheet.write({sheet.corner.x, y + 3}, palette::text, text); };
    const auto gene_bar = [&](std::size_t gene, Colour colour, float value) {
        sheet.list.AddRectFilled({left_of(gene), y}, {left_of(gene) + cell - 2, y + bar}, ink(colour));
        sheet.write_centred({middle_of(gene) - 1, y + bar / 2}, text_on(colour), print("%.4g", double{value}));
    };
    const auto parent_colour = [](bool second) { return second ? palette::second_parent : palette::first_parent; };
    const bool alone = descendant.second_genes().empty() || descendant.kind() != evod::v1::DESCENDANT_KIND_CHILD;

    for (std::size_t gene = 0; gene < count; ++gene) {
        const std::string name = gene < gene_names.size() ? gene_names[gene] : "gene " + std::to_string(gene);
        // Two words one above the other: cells are narrow.
        const std::size_t cut = name.find('_');
        sheet.write_centred({middle_of(gene), y + line / 2}, palette::text_quiet, name.substr(0, cut));
        if (cut != std::string::npos) {
            sheet.write_centred({middle_of(gene), y + 1.5f * line}, palette::text_quiet, name.substr(cut + 1));
        }
    }
    y += 2 * line + 4;

    // ---- parents
    const float parents_top = y;
    const auto parent = [&](bool second, const google::protobuf::RepeatedField<float>& genes, std::uint32_t id,
                            const char* role) {
        label(print("%s %u", role, id));
        for (std::size_t gene = 0; gene < count; ++gene) {
            const bool given = family.crossed[gene].from_second == second;
            gene_bar(gene, faint(parent_colour(second), given ? 255 : 110), genes.Get(static_cast<int>(gene)));
        }
        y += bar + 4;
    };
    parent(false, descendant.first_genes(), descendant.first_parent(), alone ? "itself" : "parent");
    if (!alone) {
        parent(true, descendant.second_genes(), descendant.second_parent(), "parent");
        y += 6;
        label("crossed");
        for (std::size_t gene = 0; gene < count; ++gene) {
            gene_bar(gene, parent_colour(family.crossed[gene].from_second), family.crossed[gene].value);
        }
        y += bar;
        for (const std::uint32_t cut : family.cuts) {
            for (float dash = parents_top - 4; dash < y + 4; dash += 8) {
                sheet.list.AddLine({left_of(cut) - 1, dash}, {left_of(cut) - 1, std::min(dash + 5, y + 4)},
                                   ink(palette::glass_current), 2);
            }
        }
        y += 4;
    }

    // ---- permutation
    if (descendant.has_order_mutation()) {
        const float from_y = y, to_y = y + 34;
        label(descendant.order_mutation().method());
        for (const GeneMove& move : family.moves) {
            const ImVec2 from{middle_of(move.from), from_y}, to{middle_of(move.to), to_y};
            sheet.list.AddBezierCubic(from, {from.x, from.y + 18}, {to.x, to.y - 18}, {to.x, to.y - 5},
                                      ink(palette::text), 1.5f);
            sheet.list.AddTriangleFilled({to.x - 5, to.y - 8}, {to.x + 5, to.y - 8}, to, ink(palette::text));
        }
        y = to_y + 2;
        for (std::size_t gene = 0; gene < count; ++gene) {
            gene_bar(gene, parent_colour(family.arranged[gene].from_second), family.arranged[gene].value);
        }
        y += bar + 4;
    }

    // ---- mutations: for each gene one below the other
    if (!family.changes.empty()) {
        y += 4;
        label("mutations");
        std::vector<float> next_y(count, y + 3);
        for (const GeneChange& change : family.changes) {
            float& row = next_y[change.gene];
            const bool bound = change.kind == evod::v1::MUTATION_KIND_CLAMP;
            const Colour colour = bound ? palette::stopped : palette::glass_mutated;
            sheet.write_centred({middle_of(change.gene), row + line / 2}, colour, shown_delta(change.delta()));
            sheet.write_centred({middle_of(change.gene), row + 1.5f * line}, colour, shown_mutation(change.kind));
            sheet.write_centred({middle_of(change.gene), row + 2.5f * line}, colour,
                                print("to %.4g", double{change.after}));
            if (bound) {
                sheet.list.AddRect({left_of(change.gene), row - 1}, {left_of(change.gene) + cell - 2, row + 3 * line},
                                   ink(colour));
            }
            if (pointed_at({left_of(change.gene), row}, {left_of(change.gene) + cell, row + 3 * line})) {
                ImGui::SetTooltip("%s: from %.7g to %.7g, %s", shown_mutation(change.kind), double{change.before},
                                  double{change.after}, shown_delta(change.delta()).c_str());
            }
            row += 3 * line + 4;
        }
        y = *std::ranges::max_element(next_y) + 2;
    }

    // ---- what came of it
    y += 4;
    label(print("organism %u", descendant.id()));
    std::vector<bool> changed(count);
    for (const GeneChange& change : family.changes) {
        changed[change.gene] = true;
    }
    for (std::size_t gene = 0; gene < count; ++gene) {
        const float value = gene < static_cast<std::size_t>(descendant.genes_size())
                                ? descendant.genes(static_cast<int>(gene))
                                : family.genes[gene];
        gene_bar(gene, parent_colour(family.arranged[gene].from_second), value);
        if (changed[gene]) {
            sheet.list.AddRect({left_of(gene) - 1, y - 1}, {left_of(gene) + cell - 1, y + bar + 1},
                               ink(palette::glass_mutated), 0, 0, 3);
        }
    }
    return y + bar + 4 - sheet.corner.y;
}

} // namespace evod::viewer
