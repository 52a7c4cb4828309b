#include "client/viewer/panels/breeding/selection_drawing.h"

#include "client/viewer/panels/breeding/tournament.h"
#include "client/viewer/panels/breeding/wheel_layout.h"
#include "client/viewer/text/numbers.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace evod::viewer {

namespace {

std::string tooltip_of(std::uint32_t organism, const evod::v1::Contender& contender, bool complete) {
    std::string text =
        print("organism %u\nrank %u, fitness ", organism, contender.rank() + 1) + three_digits(contender.fitness());
    if (contender.slot_end() > contender.slot_begin()) {
        text += "\nweight " + three_digits(contender.weight()) + ": " +
                three_digits(100 * (contender.slot_end() - contender.slot_begin())) + " % of the wheel";
    }
    text += "\nexpected picks " + three_digits(contender.expected_copies());
    if (complete) {
        text += print(", observed %u", contender.copies());
    }
    if (contender.has_migrant()) {
        text += print("\ncame from island %u, organism %u there", contender.migrant().island(),
                      contender.migrant().organism());
    }
    return text;
}

/// Draws one bar per rank. If there are more ranks than pixels, each bar shows the mean of neighbouring ranks.
template <class ValueOf, class OrganismOf>
void draw_bars(const Sheet& sheet, const std::string& title, std::size_t count, ValueOf value_of,
               OrganismOf organism_of, const BreedingRecord& record, std::span<const std::uint32_t> copies,
               const evod::v1::Pick* current, bool complete) {
    sheet.write(sheet.corner, palette::text, title);
    const float top = sheet.corner.y + 2 * sheet.line_height(), bottom = sheet.end().y - 2;
    if (count == 0 || bottom - top < 10 || sheet.size.x < 10) {
        return;
    }
    double least = 0, most = 0;
    for (std::size_t rank = 0; rank < count; ++rank) {
        least = std::min(least, value_of(rank));
        most = std::max(most, value_of(rank));
    }
    const double span = most > least ? most - least : 1;
    const auto y_of = [&](double value) {
        return bottom - static_cast<float>((value - least) / span) * (bottom - top);
    };
    const std::size_t columns = std::min(count, static_cast<std::size_t>(sheet.size.x / 2));
    const float width = sheet.size.x / static_cast<float>(columns);
    const float gap = width > 5 ? 1.f : 0.f;
    for (std::size_t i = 0; i < columns; ++i) {
        const std::size_t first = i * count / columns, end = (i + 1) * count / columns;
        double mean = 0;
        bool picked = false, picked_now = false;
        for (std::size_t rank = first; rank < end; ++rank) {
            mean += value_of(rank) / static_cast<double>(end - first);
            picked = picked || (rank < copies.size() && copies[rank] > 0);
            picked_now = picked_now || (current != nullptr && organism_of(rank) == current->organism());
        }
        const float left = sheet.corner.x + static_cast<float>(i) * width;
        const ImVec2 a{left, std::min(y_of(mean), y_of(0))}, b{left + width - gap, std::max(y_of(mean), y_of(0)) + 1};
        sheet.list.AddRectFilled(a, b, ink(rank_colour(static_cast<double>(first), static_cast<std::uint32_t>(count))));
        const float middle = left + (width - gap) / 2;
        if (picked_now) {
            sheet.list.AddTriangleFilled({middle - 6, a.y - 12}, {middle + 6, a.y - 12}, {middle, a.y - 2},
                                         ink(palette::glass_current));
        } else if (picked) {
            sheet.list.AddCircleFilled({middle, a.y - 5}, 2.5f, ink(palette::text_quiet));
        }
        if (end - first == 1 && pointed_at({left, top - 12}, {left + width, bottom})) {
            if (const auto* contender = record.contender(organism_of(first))) {
                ImGui::SetTooltip("%s", tooltip_of(organism_of(first), *contender, complete).c_str());
            }
        }
    }
    sheet.list.AddLine({sheet.corner.x, y_of(0)}, {sheet.end().x, y_of(0)}, ink(palette::text_quiet));
    sheet.write_to_the_left({sheet.end().x, sheet.corner.y}, palette::text_quiet,
                            three_digits(value_of(0)) + " (rank 1) to " + three_digits(value_of(count - 1)) +
                                print(" (rank %zu)", count));
}

float angle_of(double turns) {
    return static_cast<float>((turns - 0.25) * 2 * std::numbers::pi); // the first slot begins at the top
}

ImVec2 point_on_circle(ImVec2 centre, float radius, double turns) {
    return {centre.x + radius * std::cos(angle_of(turns)), centre.y + radius * std::sin(angle_of(turns))};
}

void stroke_arc(const Sheet& sheet, ImVec2 centre, float radius, double begin, double end, Colour colour,
                float thickness) {
    const int segments = std::max(2, static_cast<int>((end - begin) * 180));
    sheet.list.PathArcTo(centre, radius, angle_of(begin), angle_of(end), segments);
    sheet.list.PathStroke(ink(colour), 0, thickness);
}

} // namespace

void draw_ranking(const Sheet& sheet, const BreedingRecord& record, const Comparison& comparison,
                  std::span<const std::uint32_t> copies, const evod::v1::Pick* current, bool complete) {
    const std::size_t count = comparison.organisms.size();
    const auto organism_of = [&](std::size_t rank) { return comparison.organisms[rank]; };
    const auto fitness_of = [&](std::size_t rank) { return comparison.fitness[rank]; };
    const auto weight_of = [&](std::size_t rank) { return record.contender(organism_of(rank))->weight(); };
    const std::string method = record.choice("selection"), scaling = record.choice("fitness_scaling");
    const bool scaled = (method == "roulette" || method == "stochastic_universal") && scaling != "none";
    Sheet upper = sheet;
    if (scaled) {
        upper.size.y = sheet.size.y / 2 - 6;
        Sheet lower = sheet;
        lower.corner.y += sheet.size.y / 2 + 6;
        lower.size.y = sheet.size.y / 2 - 6;
        draw_bars(lower, "Weight", count, weight_of, organism_of, record, {}, nullptr, complete);
    }
    draw_bars(upper, "Fitness", count, fitness_of, organism_of, record, copies, current, complete);
}

void draw_wheel(const Sheet& sheet, const BreedingRecord& record, std::uint32_t index, bool complete) {
    const evod::v1::Breeding& breeding = record.breeding();
    const float outer = std::min(sheet.size.x, sheet.size.y) / 2 - 26;
    if (outer < 30) {
        return;
    }
    const ImVec2 centre{sheet.corner.x + sheet.size.x / 2, sheet.corner.y + sheet.size.y / 2};
    const float inner = outer * 0.6f, middle = (outer + inner) / 2, thickness = outer - inner;
    const double circumference = 2 * std::numbers::pi * outer;
    stroke_arc(sheet, centre, middle, 0, 1, palette::strip_edge, thickness); // slots not yet received
    const evod::v1::Pick* pick = record.pick(index);
    for (const Arc& arc : wheel_arcs(breeding.contenders(), circumference)) {
        stroke_arc(sheet, centre, middle, arc.begin, arc.end, rank_colour(arc.rank, breeding.contender_count()),
                   thickness);
        if ((arc.end - arc.begin) * circumference > 4) {
            sheet.list.AddLine(point_on_circle(centre, inner, arc.begin), point_on_circle(centre, outer, arc.begin),
                               ink(palette::background));
            if (arc.first == arc.last && (arc.end - arc.begin) * circumference > 26) {
                const Colour paper = rank_colour(arc.rank, breeding.contender_count());
                sheet.write_centred(point_on_circle(centre, middle, (arc.begin + arc.end) / 2), palette::text_on(paper),
                                    std::to_string(arc.first));
            }
        }
    }
    const evod::v1::Contender* chosen = pick != nullptr ? record.contender(pick->organism()) : nullptr;
    if (chosen != nullptr && chosen->slot_end() > chosen->slot_begin()) {
        for (const float radius : {inner, outer}) {
            stroke_arc(sheet, centre, radius, chosen->slot_begin(), chosen->slot_end(), palette::glass_current, 3);
        }
        for (const double side : {chosen->slot_begin(), chosen->slot_end()}) {
            sheet.list.AddLine(point_on_circle(centre, inner, side), point_on_circle(centre, outer, side),
                               ink(palette::glass_current), 2);
        }
    }
    // In stochastic universal sampling one spin sets all pointers; in roulette selection the wheel is spun for each
    // pick.
    const bool all_at_once = record.choice("selection") == "stochastic_universal";
    const auto ticks = all_at_once ? static_cast<std::uint32_t>(breeding.picks_size()) : index;
    for (std::uint32_t i = 0; i < ticks && record.pick(i) != nullptr; ++i) {
        const double turns = record.pick(i)->turns();
        sheet.list.AddLine(point_on_circle(centre, outer + 2, turns), point_on_circle(centre, outer + 9, turns),
                           ink(i < index ? palette::text : faint(palette::text_quiet, 130)), 1.5f);
    }
    if (pick != nullptr && pick->has_turns()) {
        const double turns = pick->turns(), half = 7 / circumference;
        sheet.list.AddTriangleFilled(point_on_circle(centre, outer + 1, turns),
                                     point_on_circle(centre, outer + 18, turns - half),
                                     point_on_circle(centre, outer + 18, turns + half), ink(palette::glass_current));
        sheet.list.AddLine(point_on_circle(centre, inner, turns), point_on_circle(centre, outer, turns),
                           ink(palette::glass_current), 1.5f);
    }
    if (chosen != nullptr) {
        const float line = sheet.line_height();
        sheet.write_centred({centre.x, centre.y - line}, palette::text, print("organism %u", pick->organism()));
        sheet.write_centred(centre, palette::text,
                            print("rank %u of %u", chosen->rank() + 1, breeding.contender_count()));
        sheet.write_centred({centre.x, centre.y + line}, palette::text,
                            three_digits(100 * (chosen->slot_end() - chosen->slot_begin())) +
                                (inner > 5 * sheet.font.FontSize ? " % of the wheel" : " %"));
    }
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const float x = mouse.x - centre.x, y = mouse.y - centre.y, radius = std::hypot(x, y);
    if (radius >= inner && radius <= outer && pointed_at(sheet.corner, sheet.end())) {
        const double turns = std::atan2(y, x) / (2 * std::numbers::pi) + 0.25;
        if (const auto* slot = slot_at(breeding.contenders(), turns < 0 ? turns + 1 : turns)) {
            for (int i = 0; i < breeding.contenders_size(); ++i) {
                if (&breeding.contenders(i) == slot) {
                    ImGui::SetTooltip("%s", tooltip_of(static_cast<std::uint32_t>(i), *slot, complete).c_str());
                }
            }
        }
    }
}

void draw_tournament(const Sheet& sheet, const BreedingRecord& record, std::uint32_t index, bool complete) {
    const std::vector<Contestant> contestants = contestants_of(record, index);
    if (contestants.empty()) {
        return;
    }
    double least = 0, most = 0;
    for (const Contestant& contestant : contestants) {
        if (const auto* contender = record.contender(contestant.organism)) {
            least = std::min(least, contender->fitness());
            most = std::max(most, contender->fitness());
        }
    }
    const double span = most > least ? most - least : 1;
    const float row_height = sheet.line_height() + 4;
    const auto rows = std::max<std::size_t>(1, static_cast<std::size_t>(sheet.size.y / row_height));
    const std::size_t columns = (contestants.size() + rows - 1) / rows;
    const std::size_t used_rows = std::min(rows, contestants.size());
    const float width = sheet.size.x / static_cast<float>(columns),
                height = std::clamp(sheet.size.y / static_cast<float>(used_rows), row_height, 4 * row_height);
    const float label_width = 4.4f * sheet.font.FontSize, bar_width = width - 9.7f * sheet.font.FontSize;
    for (std::size_t i = 0; i < contestants.size(); ++i) {
        const Contestant& contestant = contestants[i];
        const ImVec2 corner{sheet.corner.x + static_cast<float>(i / rows) * width,
                            sheet.corner.y + static_cast<float>(i % rows) * height};
        const float text_y = corner.y + (height - 4 - sheet.font.FontSize) / 2; // beside the middle of the bar
        sheet.write({corner.x, text_y}, palette::text, print("%u", contestant.organism));
        const auto* contender = record.contender(contestant.organism);
        if (contender == nullptr) {
            continue;
        }
        const auto length = static_cast<float>((contender->fitness() - least) / span) * std::max(bar_width, 4.f);
        const ImVec2 begin{corner.x + label_width, corner.y + 2}, end{begin.x + length + 1, begin.y + height - 6};
        sheet.list.AddRectFilled(begin, end, ink(rank_colour(contender->rank(), record.breeding().contender_count())));
        if (contestant.won) {
            sheet.list.AddRect({begin.x - 2, begin.y - 2}, {end.x + 2, end.y + 2},
                               ink(contestant.picked_now ? palette::glass_current : palette::text), 0, 0,
                               contestant.picked_now ? 3.f : 1.5f);
        }
        sheet.write({end.x + 6, text_y}, contestant.won ? palette::text : palette::text_quiet,
                    three_digits(contender->fitness()) + (contestant.won ? " won" : ""));
        if (pointed_at(corner, {corner.x + width, corner.y + height})) {
            ImGui::SetTooltip("%s", tooltip_of(contestant.organism, *contender, complete).c_str());
        }
    }
}

void draw_picks(const Sheet& sheet, const BreedingRecord& record, std::uint32_t index) {
    const std::vector<PickColumn> columns = pick_columns(record, index, static_cast<std::size_t>(sheet.size.x));
    const float width =
        std::min(sheet.size.y, sheet.size.x / static_cast<float>(std::max<std::size_t>(columns.size(), 1)));
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const ImVec2 corner{sheet.corner.x + static_cast<float>(i) * width, sheet.corner.y};
        const ImVec2 end{corner.x + width - (width > 4 ? 1.f : 0.f), sheet.end().y};
        const auto rank = columns[i].rank;
        sheet.list.AddRectFilled(
            corner, end,
            ink(rank ? rank_colour(*rank, record.breeding().contender_count()) : faint(palette::strip_edge, 90)));
    }
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (columns[i].first <= index && index <= columns[i].last) {
            const float left = sheet.corner.x + static_cast<float>(i) * width;
            sheet.list.AddRect({left - 1, sheet.corner.y - 2}, {left + std::max(width, 2.f), sheet.end().y + 2},
                               ink(palette::glass_current), 0, 0, 2);
        }
    }
}

void draw_copies(const Sheet& sheet, const Comparison& comparison, std::span<const std::uint32_t> copies,
                 double expected_share, bool complete) {
    const float line = sheet.line_height(), margin = 1.6f * sheet.font.FontSize; // the margin contains "+2" and "−2"
    const float height = sheet.size.y - (complete ? 3 : 2) * line, right_end = sheet.end().x - margin;
    if (height < 40 || right_end - sheet.corner.x < 40) {
        return;
    }
    const auto most_columns = static_cast<std::size_t>((right_end - sheet.corner.x) / 3);
    const std::vector<RankColumn> columns = rank_columns(comparison, copies, expected_share, most_columns);
    double most = 1;
    for (const RankColumn& column : columns) {
        most = std::max({most, column.copies, column.expected});
    }
    const float top = sheet.corner.y + line, bottom = top + height * (complete ? 0.62f : 1.f);
    const float width = (right_end - sheet.corner.x) / static_cast<float>(columns.size()), gap = width > 5 ? 1.f : 0.f;
    const auto y_of = [&](double value) { return bottom - static_cast<float>(value / most) * (bottom - top); };
    sheet.write(sheet.corner, palette::text, "Picks by rank; line: expected");
    if (right_end - sheet.corner.x > 16 * sheet.font.FontSize) {
        sheet.write_to_the_left({right_end, sheet.corner.y}, palette::text_quiet, "up to " + three_digits(most));
    }

    // The axis of the deviations ends at four standard errors; larger deviations are drawn at its end.
    constexpr double deviation_max = 4;
    const float lower_top = bottom + 2 * line, lower_bottom = sheet.end().y, zero = (lower_top + lower_bottom) / 2;
    const auto deviation_y = [&](double deviation) {
        return zero - static_cast<float>(std::clamp(deviation, -deviation_max, deviation_max) / deviation_max) *
                          (lower_bottom - lower_top) / 2;
    };
    if (complete) {
        sheet.list.AddRectFilled({sheet.corner.x, deviation_y(2)}, {right_end, deviation_y(-2)},
                                 ink(faint(palette::text_quiet, 36)));
        sheet.list.AddLine({sheet.corner.x, zero}, {right_end, zero}, ink(palette::text_quiet));
        sheet.write({sheet.corner.x, lower_top - line}, palette::text, "Deviation in standard errors");
        for (const auto& [deviation, label] : {std::pair{2.0, "+2"}, std::pair{-2.0, "−2"}}) {
            sheet.write_to_the_left({sheet.end().x, deviation_y(deviation) - line / 2}, palette::text_quiet, label);
        }
    }
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const RankColumn& column = columns[i];
        const float left = sheet.corner.x + static_cast<float>(i) * width, right = left + width - gap;
        sheet.list.AddRectFilled({left, y_of(column.copies)}, {right, bottom},
                                 ink(rank_colour(static_cast<double>(column.first),
                                                 static_cast<std::uint32_t>(comparison.organisms.size()))));
        sheet.list.AddLine({left, y_of(column.expected)}, {left + width, y_of(column.expected)},
                           ink(palette::glass_current), 2);
        if (complete) {
            sheet.list.AddRectFilled(
                {left, deviation_y(std::max(column.deviation, 0.0))},
                {right, deviation_y(std::min(column.deviation, 0.0)) + 1},
                ink(std::abs(column.deviation) > 2 ? palette::glass_current : palette::text_quiet));
        }
        if (pointed_at({left, top}, {left + width, complete ? lower_bottom : bottom})) {
            std::string note =
                column.first == column.last
                    ? print("rank %zu: organism %u, fitness ", column.first + 1, comparison.organisms[column.first]) +
                          three_digits(comparison.fitness[column.first])
                    : print("ranks %zu to %zu", column.first + 1, column.last + 1);
            note += print("\npicks %.0f, expected ", column.copies) + three_digits(column.expected);
            if (complete) {
                note += "\n" + with_sign(column.deviation) + " standard errors";
            }
            ImGui::SetTooltip("%s", note.c_str());
        }
    }
    sheet.list.AddLine({sheet.corner.x, bottom}, {right_end, bottom}, ink(palette::text_quiet));
    sheet.write({sheet.corner.x, bottom + 2}, palette::text_quiet, "rank 1");
    sheet.write_to_the_left({right_end, bottom + 2}, palette::text_quiet,
                            print("rank %zu", comparison.organisms.size()));
}

} // namespace evod::viewer
