#include "client/viewer/panels/plots/plot.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/offscreen.h"
#include "client/viewer/text/numbers.h"

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <imgui_internal.h> // SetItemUsingMouseWheel

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace evod::viewer {

namespace {

constexpr float gap = 6; // space around text
constexpr float tick_pixels = 4;
constexpr float line_pixels = 1.6f;
constexpr float dash_pixels = 6, dash_gap_pixels = 4;
constexpr std::uint8_t dense_alpha = 110;
constexpr double y_room = 0.04; // space above and below, as a share of the height
constexpr double zoom_of_one_notch = 1.25;
constexpr double x_units_min = 4; // least visible width of the x axis, in generations or other units of x
constexpr std::uint8_t raw_alpha = 80;
constexpr float mark_pixels = 5;      // marks nearer than this are drawn as one and read together
constexpr std::size_t mark_lines = 8; // marks that a note lists

/// A line of a note. If it is about a series, it begins with a square in the colour of the series.
struct NoteLine {
    std::string text;
    std::optional<Colour> colour = std::nullopt;
};

/// Builds a note beside the plot, at the height of the mouse.
void build_note(std::span<const NoteLine> lines, Box plot) {
    const ImGuiStyle& style = ImGui::GetStyle();
    const float square = ImGui::GetFontSize() * 0.7f, wrap = ImGui::GetFontSize() * 24;
    const float indent = square + gap;
    Corner size{0, -style.ItemSpacing.y};
    for (const NoteLine& line : lines) {
        const ImVec2 text = ImGui::CalcTextSize(line.text.c_str(), nullptr, false, wrap);
        size.x = std::max(size.x, text.x + (line.colour ? indent : 0));
        size.y += text.y + style.ItemSpacing.y;
    }
    size = {size.x + 2 * style.WindowPadding.x, size.y + 2 * style.WindowPadding.y};
    const ImGuiIO& io = ImGui::GetIO();
    const Corner place = note_place(plot, size, io.MousePos.y, {io.DisplaySize.x, io.DisplaySize.y});
    ImGui::SetNextWindowPos({place.x, place.y});
    ImGui::SetNextWindowSize({size.x, size.y});
    ImGui::BeginTooltip();
    for (const NoteLine& line : lines) {
        if (line.colour) {
            const ImVec2 at = ImGui::GetCursorScreenPos();
            const float top = std::round(at.y + (ImGui::GetFontSize() - square) / 2);
            ImGui::GetWindowDrawList()->AddRectFilled({at.x, top}, {at.x + square, top + square}, ink(*line.colour));
            ImGui::SetCursorPosX(ImGui::GetCursorPosX() + indent);
        }
        ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + wrap + 1);
        ImGui::TextUnformatted(line.text.c_str());
        ImGui::PopTextWrapPos();
    }
    ImGui::EndTooltip();
}

/// Draws a plot inside a box on a draw list.
class Drawing {
  public:
    Drawing(ImDrawList& list, ImFont& font, const Plot& plot, std::string title, Range x, Box box)
        : list_{list}, font_{font}, plot_{plot}, title_{std::move(title)}, x_{x}, area_{box} {
        lay_out(box);
    }

    /// Creates a drawing without axes. `y` is the vertical range of the box.
    Drawing(ImDrawList& list, ImFont& font, const Plot& plot, Range x, Range y, Box box)
        : list_{list}, font_{font}, plot_{plot}, x_{x}, y_{y}, area_{box} {
        legend_left_ = box.left + gap / 2;
        legend_right_ = box.right - gap / 2;
        legend_top_ = box.top + gap / 2;
        area_.top += plot.title.empty() ? 0 : font.FontSize + gap;
        group(columns());
    }

    /// Returns the rectangle in which the data are drawn.
    const Box& area() const { return area_; }
    double x_at(float pixels) const { return x_.min + (pixels - area_.left) / columns() * x_.width(); }

    void draw() {
        list_.AddRectFilled({area_.left, area_.top}, {area_.right, area_.bottom}, ink(palette::plot_background));
        draw_axes();
        draw_series();
        list_.AddRect({area_.left, area_.top}, {area_.right, area_.bottom}, ink(palette::strip_edge));
        draw_legend();
    }

    /// Draws the title, the names of the series and the lines inside `box`.
    void draw_without_axes(Box box) {
        list_.AddRectFilled({box.left, box.top}, {box.right, box.bottom}, ink(palette::plot_background));
        draw_series();
        list_.AddRect({box.left, box.top}, {box.right, box.bottom}, ink(palette::strip_edge));
        write(legend_left_, legend_top_, palette::text_quiet, plot_.title);
        legend_left_ += width_of(plot_.title) + 2 * gap;
        draw_legend();
    }

    /// Returns the x of the numbers nearest to a column of the screen; nullopt if there are none.
    std::optional<double> x_near(float mouse) const {
        const double at = x_at(mouse);
        std::optional<double> found;
        for (const Series& series : plot_.series) {
            if (const auto index = nearest(series.x, at);
                index && (!found || std::abs(series.x[*index] - at) < std::abs(*found - at))) {
                found = series.x[*index];
            }
        }
        return found && x_.contains(*found) ? found : std::nullopt;
    }

    /// Draws a vertical line at the numbers nearest to the mouse. Returns these numbers, and the marks under the mouse,
    /// as text; empty if there are none.
    std::vector<NoteLine> draw_cursor(float mouse) {
        std::vector<NoteLine> lines;
        const auto x = x_near(mouse);
        if (!x) {
            return lines;
        }
        const float pixels = column(*x);
        list_.AddLine({pixels, area_.top}, {pixels, area_.bottom}, ink(faint(palette::text_quiet, 150)));
        lines.push_back({plot_.x_label + " " + (plot_.counted_x ? shown_number(*x) : significant(*x))});
        for (const Series& series : plot_.series) {
            const auto index = nearest(series.x, *x);
            if (!index || series.name.empty() || series.x[*index] != *x || !std::isfinite(series.y[*index])) {
                continue;
            }
            if (series.kind == Series::Kind::Line || series.kind == Series::Kind::Dashes) {
                list_.AddCircleFilled({pixels, row(series.y[*index])}, 3, ink(series.colour));
            }
            lines.push_back({series.name + ": " + value_text(series, *index), series.colour});
        }
        add_marks_near(mouse, lines);
        if (!plot_.note_end.empty()) {
            lines.push_back({plot_.note_end});
        }
        return lines;
    }

  private:
    float width_of(const std::string& text) const { return size_of(text, font_).x; }
    void write(float x, float y, Colour colour, const std::string& text) {
        evod::viewer::write(list_, font_, {x, y}, colour, text);
    }

    std::string value_text(const Series& series, std::size_t index) const {
        const auto text = [&](double number) { return series.whole ? shown_number(number) : significant(number); };
        if (series.kind == Series::Kind::Band) {
            return text(series.low[index]) + " to " + text(series.y[index]);
        }
        return series.raw.empty()
                   ? text(series.y[index])
                   : text(series.raw[index]) + " (" + plot_.smoothed + ": " + significant(series.y[index]) + ")";
    }

    void add_marks_near(float mouse, std::vector<NoteLine>& lines) const {
        std::size_t more = 0;
        const std::size_t lines_max = lines.size() + mark_lines;
        for (const Marks& marks : plot_.marks) {
            for (const Mark& mark : marks.marks) {
                if (!x_.contains(mark.x) || std::abs(column(mark.x) - mouse) > mark_pixels) {
                    continue;
                }
                if (lines.size() >= lines_max) {
                    ++more;
                    continue;
                }
                lines.push_back({mark.text + (marks.name.empty() ? "" : " (" + marks.name + ")"), palette::plot_mark});
            }
        }
        if (more > 0) {
            lines.push_back({"and " + with_separators(more) + " more changes"});
        }
    }

    void draw_marks() {
        const double distance = mark_pixels / columns() * x_.width();
        for (std::size_t i = 0; i < plot_.marks.size(); ++i) {
            const std::span<const Mark> marks = plot_.marks[i].marks;
            for (const Group group : mark_groups(marks, x_, distance)) {
                const float x = std::round(column(marks[group.begin].x)), half = mark_pixels - 1;
                const ImVec2 corners[] = {{x - half, area_.top}, {x + half, area_.top}, {x, area_.top + 2 * half}};
                for (float y = area_.top + 2 * half; y < area_.bottom; y += 5) {
                    list_.AddLine({x, y}, {x, std::min(y + 2, area_.bottom)}, ink(palette::plot_mark));
                }
                if (i == 0) {
                    list_.AddTriangleFilled(corners[0], corners[1], corners[2], ink(palette::plot_mark));
                } else { // of the compared history
                    list_.AddTriangle(corners[0], corners[1], corners[2], ink(palette::plot_mark), 1.5f);
                }
            }
        }
    }

    double columns() const { return std::max(area_.right - area_.left, 1.0f); }
    float column(double x) const {
        return area_.left + static_cast<float>(std::clamp((x - x_.min) / x_.width(), -1.0, 2.0) * columns());
    }
    float row(double y) const {
        const double share = std::clamp((y - y_.min) / y_.width(), -1.0, 2.0);
        return area_.bottom - static_cast<float>(share * (area_.bottom - area_.top));
    }

    void group(double columns) {
        for (const Series& series : plot_.series) {
            groups_.push_back(groups_of(series.x, x_, static_cast<std::size_t>(columns)));
        }
    }

    /// Computes the groups of every series, the tops of the stacks, the y range, and the data area that remains beside
    /// the labels.
    void lay_out(Box box) {
        const float letter = font_.FontSize;
        if (!title_.empty()) {
            title_top_ = box.top;
            box.top += letter + 2 * gap;
        }
        legend_top_ = box.top;
        legend_left_ = box.left;
        legend_right_ = box.right;
        label_top_ = box.top + static_cast<float>(legend_rows(legend_width())) * (letter + 2);
        area_.top = label_top_ + letter + gap;
        area_.bottom = box.bottom - 2 * letter - gap - tick_pixels;
        area_.bottom = std::max(area_.bottom, area_.top + 1);
        label_left_ = box.left;

        std::optional<Range> y;
        group(std::max(box.right - box.left, 1.0f));
        for (std::size_t i = 0; i < plot_.series.size(); ++i) {
            const Series& series = plot_.series[i];
            const std::vector<Group>& groups = groups_[i];
            if (groups.empty()) {
                continue;
            }
            const std::size_t begin = groups.front().begin, end = groups.back().end;
            if (series.kind == Series::Kind::Stack) {
                add_stack(series, groups);
                y = joined(y, range_of(tops_));
                continue;
            }
            y = joined(y, range_of(series.y.subspan(begin, end - begin)));
            if (!series.raw.empty()) {
                y = joined(y, range_of(series.raw.subspan(begin, end - begin)));
            }
            if (series.kind == Series::Kind::Band) {
                y = joined(y, range_of(series.low.subspan(begin, end - begin)));
            }
        }
        const bool starts_at_zero = plot_.from_zero && (!y || y->min >= 0);
        y = y ? y : std::optional{Range{0, 1}};
        y_ = with_room(starts_at_zero ? Range{0, y->max} : *y, y_room);
        if (y->min >= 0) { // no room below 0 for numbers that are never negative
            y_ = {starts_at_zero ? 0 : std::max(y_.min, 0.0), std::max(y_.max, 1e-9)};
        }
        y_ticks_ = ticks_in(y_, std::max(2, static_cast<int>((area_.bottom - area_.top) / (1.7f * letter))));
        float widest = 0;
        for (const double tick : y_ticks_.at) {
            widest = std::max(widest, width_of(tick_label(tick, y_ticks_.step)));
        }
        area_.left = box.left + widest + gap + tick_pixels;
        area_.right = std::max(box.right - gap, area_.left + 1);
    }

    /// Adds the group means of a series to the tops of the stacks drawn so far. All stacked series of a plot have the
    /// same x.
    void add_stack(const Series& series, std::span<const Group> groups) {
        tops_.resize(groups.size());
        for (std::size_t i = 0; i < groups.size(); ++i) {
            tops_[i] += mean_of(series.y, groups[i]);
        }
    }

    void draw_axes() {
        const float letter = font_.FontSize;
        write(label_left_, label_top_, palette::text_quiet, plot_.y_label);
        for (const double tick : y_ticks_.at) {
            const float y = std::round(row(tick));
            const std::string label = tick_label(tick, y_ticks_.step);
            list_.AddLine({area_.left, y}, {area_.right, y}, ink(palette::plot_grid));
            write(area_.left - tick_pixels - gap / 2 - width_of(label), y - letter / 2, palette::text, label);
        }
        const Ticks ticks =
            ticks_in(x_, std::max(2, static_cast<int>(columns() / (6 * letter))), plot_.counted_x ? 1 : 0);
        for (const double tick : ticks.at) {
            const float x = std::round(column(tick));
            const std::string label = tick_label(tick, ticks.step);
            const float width = width_of(label);
            list_.AddLine({x, area_.bottom}, {x, area_.bottom + tick_pixels}, ink(palette::strip_edge));
            list_.AddLine({x, area_.top}, {x, area_.bottom}, ink(palette::plot_grid));
            write(std::min(x - width / 2, legend_right_ - width), area_.bottom + tick_pixels, palette::text, label);
        }
        write((area_.left + area_.right - width_of(plot_.x_label)) / 2, area_.bottom + tick_pixels + letter,
              palette::text_quiet, plot_.x_label);
    }

    struct Entry {
        Series::Kind kind;
        Colour colour;
        std::string text;
    };
    std::vector<Entry> legend() const {
        std::vector<Entry> entries;
        if (!plot_.solid.empty()) {
            entries.push_back({Series::Kind::Line, palette::text_quiet, plot_.solid});
            entries.push_back({Series::Kind::Dashes, palette::text_quiet, plot_.dashed});
        }
        for (const Series& series : plot_.series) {
            if (series.in_legend && !series.name.empty()) {
                entries.push_back(
                    {series.kind, series.colour, series.name + (series.newest.empty() ? "" : " " + series.newest)});
            }
        }
        return entries;
    }
    float width_of(const Entry& entry) const { return font_.FontSize + gap + width_of(entry.text) + 2 * gap; }

    /// Returns the number of rows of the legend if a row is at most this wide.
    std::size_t legend_rows(float width) const {
        const std::vector<Entry> entries = legend();
        std::size_t rows = entries.empty() ? 0 : 1;
        float at = 0;
        for (const Entry& entry : entries) {
            if (at > 0 && at + width_of(entry) > width) {
                ++rows;
                at = 0;
            }
            at += width_of(entry);
        }
        return rows;
    }
    /// Returns the least width of a row with which the legend has as few rows as possible, so that rows are of similar
    /// length.
    float legend_width() const {
        const float most = legend_right_ - legend_left_ + 2 * gap; // no gap is needed after the last entry
        float width = most;
        while (width > font_.FontSize && legend_rows(width - font_.FontSize) == legend_rows(most)) {
            width -= font_.FontSize;
        }
        return width;
    }

    void draw_legend() {
        const float letter = font_.FontSize, width = legend_width();
        if (!title_.empty()) {
            write(legend_left_, title_top_, palette::text, title_);
        }
        float x = legend_left_, y = legend_top_;
        for (const Entry& entry : legend()) {
            if (x > legend_left_ && x - legend_left_ + width_of(entry) > width) {
                x = legend_left_;
                y += letter + 2;
            }
            const float middle = std::round(y + letter / 2);
            if (entry.kind == Series::Kind::Line) {
                list_.AddLine({x, middle}, {x + letter, middle}, ink(entry.colour), 2.5f);
            } else if (entry.kind == Series::Kind::Dashes) {
                list_.AddLine({x, middle}, {x + letter * 0.4f, middle}, ink(entry.colour), 2.5f);
                list_.AddLine({x + letter * 0.6f, middle}, {x + letter, middle}, ink(entry.colour), 2.5f);
            } else {
                list_.AddRectFilled({x, y + 2}, {x + letter, y + letter - 2}, ink(entry.colour));
            }
            write(x + letter + gap, y, palette::text, entry.text);
            x += width_of(entry);
        }
    }

    void draw_series() {
        draw_marks();
        list_.PushClipRect({area_.left, area_.top}, {area_.right, area_.bottom}, true);
        for (std::size_t i = 0; i < plot_.series.size(); ++i) {
            if (plot_.series[i].kind == Series::Kind::Stack) {
                draw_stack(i);
            }
        }
        for (std::size_t i = plot_.series.size(); i-- > 0;) {
            draw(i);
        }
        list_.PopClipRect();
    }

    void draw(std::size_t index) {
        const Series& series = plot_.series[index];
        switch (series.kind) {
        case Series::Kind::Line:
        case Series::Kind::Dashes:
            if (!series.raw.empty()) {
                draw_line(Series::Kind::Line, faint(series.colour, raw_alpha), 1, series.x, series.raw, groups_[index]);
            }
            return draw_line(series.kind, series.colour, line_pixels, series.x, series.y, groups_[index]);
        case Series::Kind::Band:
            return draw_band(series, groups_[index]);
        case Series::Kind::Stack:
            return; // has already been drawn
        case Series::Kind::Bars:
            for (const Group group : groups_[index]) {
                draw_bar(series, group, 0, series.y[group.begin]);
            }
        }
    }

    void draw_line(Series::Kind kind, Colour colour, float thickness, std::span<const double> x,
                   std::span<const double> y, std::span<const Group> groups) {
        std::vector<ImVec2> points;
        // If a column of pixels has several numbers, the line moves up and down within the column, so dashes would be
        // invisible.
        const bool dense = std::ranges::any_of(groups, [](Group group) { return group.end - group.begin > 1; });
        const auto finish = [&] {
            const int count = static_cast<int>(points.size());
            if (count == 1) {
                list_.AddCircleFilled(points[0], 2, ink(colour));
            } else if (kind == Series::Kind::Dashes && !dense) {
                draw_dashes(points, ink(colour));
            } else if (kind == Series::Kind::Dashes) {
                list_.AddPolyline(points.data(), count, ink(faint(colour, dense_alpha)), 0, 1);
            } else {
                list_.AddPolyline(points.data(), count, ink(colour), 0, thickness);
            }
            points.clear();
        };
        for (const LinePoint& point : line_of(x, y, groups)) {
            if (!std::isfinite(point.y)) {
                finish();
            } else {
                points.push_back({column(point.x), row(point.y)});
            }
        }
        finish();
    }

    void draw_dashes(std::span<const ImVec2> points, ImU32 colour) {
        float left = dash_pixels; // remaining pixels of the current dash or gap
        bool dash = true;
        for (std::size_t i = 1; i < points.size(); ++i) {
            ImVec2 at = points[i - 1];
            const ImVec2 end = points[i];
            float length = std::hypot(end.x - at.x, end.y - at.y);
            while (length > 0) {
                const float step = std::min(left, length);
                const ImVec2 next{at.x + (end.x - at.x) * step / length, at.y + (end.y - at.y) * step / length};
                if (dash) {
                    list_.AddLine(at, next, colour, line_pixels);
                }
                at = next;
                length -= step;
                left -= step;
                if (left <= 0) {
                    dash = !dash;
                    left = dash ? dash_pixels : dash_gap_pixels;
                }
            }
        }
    }

    void draw_band(const Series& series, std::span<const Group> groups) {
        const std::vector<BandPoint> band = band_of(series.x, series.low, series.y, groups);
        for (std::size_t i = 1; i < band.size(); ++i) {
            list_.AddQuadFilled({column(band[i - 1].x), row(band[i - 1].high)}, {column(band[i].x), row(band[i].high)},
                                {column(band[i].x), row(band[i].low)}, {column(band[i - 1].x), row(band[i - 1].low)},
                                ink(series.colour));
        }
    }

    void draw_bar(const Series& series, Group group, double from, double to) {
        const float left = column(series.x[group.begin] - series.bar_width / 2);
        const float right = column(series.x[group.end - 1] + series.bar_width / 2);
        const float space = right - left > 6 ? 1.0f : 0.0f; // a gap only between wide bars
        list_.AddRectFilled({left + space, row(to)}, {std::max(right - space, left + 1), row(from)},
                            ink(series.colour));
    }

    void draw_stack(std::size_t index) {
        if (stack_bottoms_.size() != groups_[index].size()) {
            stack_bottoms_.assign(groups_[index].size(), 0.0);
        }
        for (std::size_t i = 0; i < groups_[index].size(); ++i) {
            const double from = stack_bottoms_[i];
            stack_bottoms_[i] += mean_of(plot_.series[index].y, groups_[index][i]);
            draw_bar(plot_.series[index], groups_[index][i], from, stack_bottoms_[i]);
        }
    }

    ImDrawList& list_;
    ImFont& font_;
    const Plot& plot_;
    std::string title_; // empty: no title
    Range x_, y_;
    Box area_;
    Ticks y_ticks_;
    std::vector<std::vector<Group>> groups_; // groups of each series
    std::vector<double> tops_;               // upper ends of all stacks, by group
    std::vector<double> stack_bottoms_;
    float title_top_ = 0, legend_top_ = 0, legend_left_ = 0, legend_right_ = 0, label_top_ = 0, label_left_ = 0;
};

Range shown_x(const Plot& plot, const PlotView& view) {
    return view.x.value_or(whole_x(plot));
}

/// Makes `list` the only list of `data`: an array of Dear ImGui before 1.89.8 is a vector in later versions.
template <class Data>
void set_lists(Data& data, ImDrawList*& list) {
    if constexpr (std::is_pointer_v<decltype(data.CmdLists)>) {
        data.CmdLists = &list;
    } else {
        data.CmdLists.push_back(list);
    }
}

} // namespace

Range whole_x(const Plot& plot) {
    std::optional<Range> whole;
    for (const Series& series : plot.series) {
        if (series.x.empty()) {
            continue;
        }
        const bool bars = series.kind == Series::Kind::Stack || series.kind == Series::Kind::Bars;
        const double half = bars ? series.bar_width / 2 : 0;
        whole = joined(whole, Range{series.x.front() - half, series.x.back() + half});
    }
    if (whole && whole->width() > 0) {
        return *whole;
    }
    return whole ? Range{whole->min - 0.5, whole->max + 0.5} : Range{0, 1};
}

void plot_widget(const char* id, const Plot& plot, PlotView& view, float height_pixels) {
    const ImVec2 place = ImGui::GetCursorScreenPos();
    const float width = std::max(ImGui::GetContentRegionAvail().x, 40.0f);
    ImGui::InvisibleButton(id, {width, std::max(height_pixels, 40.0f)});
    ImGui::SetItemUsingMouseWheel(); // prevents the window from scrolling
    const Range whole = whole_x(plot);
    if (view.x) { // the compared history may have been removed
        view.x = zoomed(*view.x, 0, 1, whole, x_units_min);
    }
    ImFont& font = *ImGui::GetFont();
    const Box box{place.x, place.y, place.x + width, place.y + std::max(height_pixels, 40.0f)};
    Drawing drawing{*ImGui::GetWindowDrawList(), font, plot, "", shown_x(plot, view), box};
    drawing.draw();

    const ImGuiIO& io = ImGui::GetIO();
    if (ImGui::IsItemHovered()) {
        const Range shown = shown_x(plot, view);
        const Box& area = drawing.area();
        const double share = std::clamp((io.MousePos.x - area.left) / (area.right - area.left), 0.0f, 1.0f);
        if (ImGui::IsMouseDoubleClicked(0)) {
            view.x.reset();
        } else if (io.MouseWheel != 0) {
            const Range next = zoomed(shown, share, std::pow(zoom_of_one_notch, io.MouseWheel), whole, x_units_min);
            view.x = next == whole ? std::nullopt : std::optional{next};
        }
        if (const auto lines = drawing.draw_cursor(io.MousePos.x); !lines.empty()) {
            build_note(lines, box);
        }
    }
    if (ImGui::IsItemActive() && view.x && io.MouseDelta.x != 0) {
        const Box& area = drawing.area();
        view.x = moved(*view.x, -io.MouseDelta.x / (area.right - area.left) * view.x->width(), whole);
    }
}

std::optional<double> curve_widget(const char* id, const Plot& plot, Range y, float height_pixels) {
    const ImVec2 place = ImGui::GetCursorScreenPos();
    const ImVec2 size{std::max(ImGui::GetContentRegionAvail().x, 40.0f), height_pixels};
    const bool clicked = ImGui::InvisibleButton(id, size);
    const Box box{place.x, place.y, place.x + size.x, place.y + size.y};
    Drawing drawing{*ImGui::GetWindowDrawList(), *ImGui::GetFont(), plot, whole_x(plot), y, box};
    drawing.draw_without_axes(box);
    if (!plot.x_label.empty() && ImGui::IsItemHovered()) {
        if (const auto lines = drawing.draw_cursor(ImGui::GetIO().MousePos.x); !lines.empty()) {
            build_note(lines, box);
        }
    }
    return clicked ? drawing.x_near(ImGui::GetIO().MousePos.x) : std::nullopt;
}

sf::Image image_of(const Plot& plot, const PlotView& view, unsigned width_pixels, unsigned height_pixels) {
    const auto width = static_cast<float>(width_pixels), height = static_cast<float>(height_pixels);
    ImFont& font = *ImGui::GetFont();
    ImDrawList list{ImGui::GetDrawListSharedData()};
    list._ResetForNewFrame();
    list.PushTextureID(font.ContainerAtlas->TexID);
    list.PushClipRect({0, 0}, {width, height});
    list.AddRectFilled({0, 0}, {width, height}, ink(palette::plot_background));
    constexpr float margin = 14;
    Drawing drawing{
        list, font, plot, plot.title, shown_x(plot, view), {margin, margin, width - margin, height - margin}};
    drawing.draw();
    ImDrawList* only_list = &list;
    ImDrawData data;
    data.Valid = true;
    set_lists(data, only_list);
    data.CmdListsCount = 1;
    data.TotalIdxCount = list.IdxBuffer.Size;
    data.TotalVtxCount = list.VtxBuffer.Size;
    data.DisplayPos = {0, 0};
    data.DisplaySize = {width, height};
    data.FramebufferScale = {1, 1};
    return draw_off_screen(width_pixels, height_pixels, [&] { ImGui_ImplOpenGL3_RenderDrawData(&data); });
}

} // namespace evod::viewer
