#include "client/viewer/panels/breeding/descendant_drawing.h"

#include "client/viewer/panels/breeding/family.h"
#include "client/viewer/text/numbers.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace evod::viewer {

namespace {

Colour parent_colour(bool second) {
    return second ? palette::second_parent : palette::first_parent;
}

/// Returns the colour of a gene: that of its parent, or between the colours of both parents if it was blended.
Colour gene_colour(const GeneOrigin& gene) {
    const Colour first = parent_colour(false), second = parent_colour(true);
    const auto middle = [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>((a + b) / 2); };
    return gene.blended ? Colour{middle(first.red, second.red), middle(first.green, second.green),
                                 middle(first.blue, second.blue)}
                        : parent_colour(gene.from_second);
}

/// Draws a family from top to bottom. Each part begins at the lower edge of the part above it.
class FamilyDrawing {
  public:
    FamilyDrawing(const Sheet& sheet, const evod::v1::Descendant& descendant, const Family& family,
                  const std::vector<std::string>& gene_names, std::size_t column_count)
        : sheet_{sheet}
        , descendant_{descendant}
        , family_{family}
        , gene_names_{gene_names}
        , count_{column_count}
        , label_width_{std::min(8 * sheet.font.FontSize, sheet.size.x / 4)}
        , cell_{(sheet.size.x - label_width_) / static_cast<float>(count_)}
        , line_{sheet.line_height()}
        , bar_{line_ + 6}
        , y_{sheet.corner.y} {
        for (std::size_t gene = 0; gene < count_; ++gene) {
            // The cells are narrow, so a name of two words is split into two lines.
            const std::string name = gene < gene_names.size() ? gene_names[gene] : "gene " + std::to_string(gene);
            const std::size_t cut = name.find('_');
            names_.push_back(cut == std::string::npos ? std::array{std::string{}, name}
                                                      : std::array{name.substr(0, cut), name.substr(cut + 1)});
            fit(names_.back()[0]);
            fit(names_.back()[1]);
        }
        for (const GeneChange& change : family_.changes) {
            if (change.gene < count_) {
                for (const std::string& text : texts_of(change)) {
                    fit(text);
                }
            }
        }
    }

    void draw_gene_names();
    void draw_parents();
    void draw_order_mutation();
    void draw_mutations();
    void draw_organism();
    void draw_other_genes();
    float height() const { return y_ - sheet_.corner.y; }

  private:
    /// Makes the text of all cells small enough for this text, but not too small to read.
    void fit(const std::string& text) {
        constexpr float text_scale_min = 0.7f, room = 6;
        const float width = std::max(size_of(text, sheet_.font).x, 1.f);
        text_scale_ = std::max(std::min(text_scale_, (cell_ - room) / width), text_scale_min);
    }
    static std::array<std::string, 3> texts_of(const GeneChange& change) {
        return {shown_delta(change.delta()), shown_mutation(change.kind), print("to %.4g", double{change.after})};
    }
    void write_in_cell(ImVec2 centre, Colour colour, const std::string& text) const {
        sheet_.write_centred(centre, colour, text, text_scale_);
    }
    float left_of(std::size_t gene) const { return sheet_.corner.x + label_width_ + static_cast<float>(gene) * cell_; }
    float middle_of(std::size_t gene) const { return left_of(gene) + cell_ / 2; }
    void draw_label(const std::string& text) const { sheet_.write({sheet_.corner.x, y_ + 3}, palette::text, text); }
    void draw_gene(std::size_t gene, Colour colour, float value) const;
    void draw_parent(bool second, const char* role);
    void draw_change(const GeneChange& change, float top) const;
    void draw_block(const GeneBlock& block, ImVec2 corner, float label_width, float cell) const;
    std::string other_genes_text() const;

    const Sheet& sheet_;
    const evod::v1::Descendant& descendant_;
    const Family& family_;
    const std::vector<std::string>& gene_names_;
    std::size_t count_; // genes that are drawn as columns; the others follow as small cells
    float label_width_, cell_, line_, bar_;
    float y_;                                       // top edge of the next part
    std::vector<std::array<std::string, 2>> names_; // of the genes, in two lines
    float text_scale_ = 1;                          // of the text in cells
};

void FamilyDrawing::draw_gene(std::size_t gene, Colour colour, float value) const {
    sheet_.list.AddRectFilled({left_of(gene), y_}, {left_of(gene) + cell_ - 2, y_ + bar_}, ink(colour));
    write_in_cell({middle_of(gene) - 1, y_ + bar_ / 2}, palette::text_on(colour), print("%.4g", double{value}));
}

void FamilyDrawing::draw_gene_names() {
    for (std::size_t gene = 0; gene < count_; ++gene) {
        write_in_cell({middle_of(gene), y_ + line_ / 2}, palette::text_quiet, names_[gene][0]);
        write_in_cell({middle_of(gene), y_ + 1.5f * line_}, palette::text_quiet, names_[gene][1]);
    }
    y_ += 2 * line_ + 4;
}

void FamilyDrawing::draw_parent(bool second, const char* role) {
    const auto& genes = second ? descendant_.second_genes() : descendant_.first_genes();
    draw_label(print("%s %u", role, second ? descendant_.second_parent() : descendant_.first_parent()));
    for (std::size_t gene = 0; gene < count_; ++gene) {
        const bool given = family_.crossed[gene].blended || family_.crossed[gene].from_second == second;
        draw_gene(gene, faint(parent_colour(second), given ? 255 : 110), genes.Get(static_cast<int>(gene)));
    }
    y_ += bar_ + 4;
}

/// Draws the parents, the child after crossover, and the cuts across all three. For a survivor, draws only the
/// survivor.
void FamilyDrawing::draw_parents() {
    const bool alone = descendant_.second_genes().empty() || descendant_.kind() != evod::v1::DESCENDANT_KIND_CHILD;
    const float top = y_;
    draw_parent(false, alone ? "itself" : "parent");
    if (alone) {
        return;
    }
    draw_parent(true, "parent");
    y_ += 6;
    draw_label("crossed");
    for (std::size_t gene = 0; gene < count_; ++gene) {
        draw_gene(gene, gene_colour(family_.crossed[gene]), family_.crossed[gene].value);
    }
    y_ += bar_;
    for (const std::uint32_t cut : family_.cuts) {
        if (cut > count_) {
            continue;
        }
        for (float dash = top - 4; dash < y_ + 4; dash += 8) {
            sheet_.list.AddLine({left_of(cut) - 1, dash}, {left_of(cut) - 1, std::min(dash + 5, y_ + 4)},
                                ink(palette::glass_current), 2);
        }
    }
    y_ += 4;
}

void FamilyDrawing::draw_order_mutation() {
    if (!descendant_.has_order_mutation()) {
        return;
    }
    const float from_y = y_, to_y = y_ + 34;
    draw_label(descendant_.order_mutation().method());
    for (const GeneMove& move : family_.moves) {
        if (move.from >= count_ || move.to >= count_) {
            continue;
        }
        const ImVec2 from{middle_of(move.from), from_y}, to{middle_of(move.to), to_y};
        sheet_.list.AddBezierCubic(from, {from.x, from.y + 18}, {to.x, to.y - 18}, {to.x, to.y - 5}, ink(palette::text),
                                   1.5f);
        sheet_.list.AddTriangleFilled({to.x - 5, to.y - 8}, {to.x + 5, to.y - 8}, to, ink(palette::text));
    }
    y_ = to_y + 2;
    for (std::size_t gene = 0; gene < count_; ++gene) {
        draw_gene(gene, gene_colour(family_.arranged[gene]), family_.arranged[gene].value);
    }
    y_ += bar_ + 4;
}

void FamilyDrawing::draw_change(const GeneChange& change, float top) const {
    const bool clamped = change.kind == evod::v1::MUTATION_KIND_CLAMP;
    const Colour colour = clamped ? palette::stopped : palette::glass_mutated;
    const float left = left_of(change.gene), middle = middle_of(change.gene);
    float row = top + line_ / 2;
    for (const std::string& text : texts_of(change)) {
        write_in_cell({middle, row}, colour, text);
        row += line_;
    }
    if (clamped) {
        sheet_.list.AddRect({left, top - 1}, {left + cell_ - 2, top + 3 * line_}, ink(colour));
    }
    if (pointed_at({left, top}, {left + cell_, top + 3 * line_})) {
        ImGui::SetTooltip("%s: from %.7g to %.7g, %s", shown_mutation(change.kind), double{change.before},
                          double{change.after}, shown_delta(change.delta()).c_str());
    }
}

/// Draws the changes of every gene below each other, in the order in which they happened.
void FamilyDrawing::draw_mutations() {
    if (std::ranges::none_of(family_.changes, [&](const GeneChange& change) { return change.gene < count_; })) {
        return;
    }
    y_ += 4;
    draw_label("mutations");
    std::vector<float> next_top(count_, y_ + 3);
    for (const GeneChange& change : family_.changes) {
        if (change.gene >= count_) {
            continue;
        }
        draw_change(change, next_top[change.gene]);
        next_top[change.gene] += 3 * line_ + 4;
    }
    y_ = *std::ranges::max_element(next_top) + 2;
}

void FamilyDrawing::draw_organism() {
    y_ += 4;
    draw_label(print("organism %u", descendant_.id()));
    const std::vector<bool> changed = family_.changed();
    for (std::size_t gene = 0; gene < count_; ++gene) {
        const float value = gene < static_cast<std::size_t>(descendant_.genes_size())
                                ? descendant_.genes(static_cast<int>(gene))
                                : family_.genes[gene];
        draw_gene(gene, gene_colour(family_.arranged[gene]), value);
        if (changed[gene]) {
            sheet_.list.AddRect({left_of(gene) - 1, y_ - 1}, {left_of(gene) + cell_ - 1, y_ + bar_ + 1},
                                ink(palette::glass_mutated), 0, 0, 3);
        }
    }
    y_ += bar_ + 4;
}

/// "66 other genes: 35 of parent 12, 31 of parent 45, 4 mutated"
std::string FamilyDrawing::other_genes_text() const {
    const std::vector<bool> changed = family_.changed();
    std::size_t first = 0, second = 0, blended = 0, mutated = 0;
    for (std::size_t gene = count_; gene < family_.genes.size(); ++gene) {
        const GeneOrigin& origin = family_.arranged[gene];
        ++(origin.blended ? blended : origin.from_second ? second : first);
        mutated += changed[gene];
    }
    std::string text = with_separators(family_.genes.size() - count_) + " other genes: ";
    text += blended > 0 ? print("means of parents %u and %u", descendant_.first_parent(), descendant_.second_parent())
                        : with_separators(first) + print(" of parent %u", descendant_.first_parent());
    if (second > 0) {
        text += ", " + with_separators(second) + print(" of parent %u", descendant_.second_parent());
    }
    return text + (mutated > 0 ? ", " + with_separators(mutated) + " mutated" : "");
}

void FamilyDrawing::draw_block(const GeneBlock& block, ImVec2 corner, float label_width, float cell) const {
    sheet_.write({corner.x, corner.y - 1}, palette::text_quiet, block.label);
    const std::vector<bool> changed = family_.changed();
    for (std::size_t i = 0; i < block.count; ++i) {
        const std::size_t gene = block.first + i;
        const float left = corner.x + label_width + static_cast<float>(i) * cell;
        const ImVec2 end{left + cell - 1, corner.y + line_ - 3};
        sheet_.list.AddRectFilled({left, corner.y}, end, ink(gene_colour(family_.arranged[gene])));
        if (changed[gene]) {
            sheet_.list.AddRect({left, corner.y}, end, ink(palette::glass_mutated), 0, 0, 3);
        }
        if (pointed_at({left, corner.y}, end)) {
            ImGui::SetTooltip("%s", gene_text(family_, gene, gene_names_[gene], descendant_).c_str());
        }
    }
}

/// Draws the genes that are not columns as small cells in the colours of their parents, neuron by neuron.
void FamilyDrawing::draw_other_genes() {
    if (family_.genes.size() <= count_ || gene_names_.size() != family_.genes.size()) {
        return;
    }
    y_ += 8;
    const std::string text = other_genes_text();
    write(sheet_.list, sheet_.font, {sheet_.corner.x, y_}, palette::text, text, sheet_.size.x);
    y_ += size_of(text, sheet_.font, sheet_.size.x).y + 6;
    const std::vector<GeneBlock> blocks = gene_blocks(gene_names_, count_);
    float label_width = 0, most = 1;
    for (const GeneBlock& block : blocks) {
        label_width = std::max(label_width, size_of(block.label, sheet_.font).x + 6);
        most = std::max(most, static_cast<float>(block.count));
    }
    const float cell = std::min((sheet_.size.x - label_width) / most, 0.8f * sheet_.font.FontSize);
    float x = 0;
    for (const GeneBlock& block : blocks) {
        const float width = label_width + static_cast<float>(block.count) * cell;
        if (x > 0 && x + width > sheet_.size.x) {
            x = 0;
            y_ += line_ + 1;
        }
        draw_block(block, {sheet_.corner.x + x, y_}, label_width, cell);
        x += width + 14;
    }
    y_ += line_ + 6;
}

} // namespace

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
                  const std::vector<std::string>& gene_names, std::size_t body_count) {
    constexpr std::size_t columns_max = 12; // more are too narrow for their numbers
    const Family family = family_of(descendant);
    if (family.genes.empty()) {
        return 0;
    }
    const std::size_t count = family.genes.size();
    FamilyDrawing drawing{sheet, descendant, family, gene_names,
                          count > columns_max && body_count > 0 ? std::min(body_count, count) : count};
    drawing.draw_gene_names();
    drawing.draw_parents();
    drawing.draw_order_mutation();
    drawing.draw_mutations();
    drawing.draw_organism();
    drawing.draw_other_genes();
    return drawing.height();
}

} // namespace evod::viewer
