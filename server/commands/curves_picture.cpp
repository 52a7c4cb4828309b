#include "server/commands/curves_picture.h"

#include "server/base/assert.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

namespace evod::commands {
namespace {

// Of the picture and of what is drawn in it, in px.
constexpr double width = 900, height = 540;
constexpr double left = 76, right = 684, top = 74, bottom = 476;
constexpr double legend_x = 708, legend_step = 26;

struct Style {
    std::string_view colour, dashes;
};
/// Of the i-th curve. Where colours begin again, dashes tell them apart.
Style style_of(std::size_t i) {
    constexpr std::array<std::string_view, 8> colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                      "#e69f00", "#56b4e9", "#000000", "#8a8000"};
    constexpr std::array<std::string_view, 4> dashes{"", "7 4", "2 3", "9 3 2 3"};
    return {colours[i % colours.size()], dashes[i / colours.size() % dashes.size()]};
}

std::string number(double value) {
    char text[64];
    const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, 2).ptr;
    std::string_view shown{text, static_cast<std::size_t>(end - text)};
    while (shown.ends_with('0')) {
        shown.remove_suffix(1);
    }
    if (shown.ends_with('.')) {
        shown.remove_suffix(1);
    }
    return shown == "-0" ? "0" : std::string{shown};
}

/// As people read it beside an axis.
std::string tick_text(double value) {
    char text[64];
    const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 6).ptr;
    std::string shown(text, end);
    if (const std::size_t minus = shown.find('-'); minus == 0) {
        shown.replace(0, 1, "−");
    }
    return shown;
}

std::string escaped(std::string_view text) {
    std::string to;
    for (const char c : text) {
        switch (c) {
        case '&':
            to += "&amp;";
            break;
        case '<':
            to += "&lt;";
            break;
        case '>':
            to += "&gt;";
            break;
        case '"':
            to += "&quot;";
            break;
        default:
            to += static_cast<unsigned char>(c) < 0x20 ? ' ' : c; // XML has no word for the others
        }
    }
    return to;
}

/// As much of a name as the legend has room for.
std::string clipped(const std::string& name) {
    constexpr std::size_t bytes_max = 21;
    return name.size() <= bytes_max ? name : name.substr(0, bytes_max - 1) + "…";
}

/// From numbers to px.
struct Scale {
    double least, greatest, begin, end;
    double operator()(double value) const { return begin + (value - least) / (greatest - least) * (end - begin); }
};

Scale scale_of(double least, double greatest, double begin, double end) {
    if (least == greatest) { // one point alone stands in the middle
        least -= 1;
        greatest += 1;
    }
    return {least, greatest, begin, end};
}

class Picture {
  public:
    void line(double x1, double y1, double x2, double y2, std::string_view colour, double stroke,
              std::string_view dashes = "") {
        svg_ += "<line x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) + "\" y2=\"" +
                number(y2) + "\"" + stroked(colour, stroke, dashes) + "/>\n";
    }
    /// anchor  "start", "middle" or "end".
    void words(double x, double y, std::string_view anchor, double size, std::string_view text,
               std::string_view more = "") {
        svg_ += "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + std::string{anchor} +
                "\" font-size=\"" + number(size) + "\"" + std::string{more} + ">" + escaped(text) + "</text>\n";
    }
    void band(const Curve& curve, const Scale& x, const Scale& y, const Style& style) {
        svg_ += "<polygon points=\"";
        for (const CurvePoint& point : curve.points) {
            at(x(point.x), y(point.high));
        }
        for (std::size_t i = curve.points.size(); i-- > 0;) {
            at(x(curve.points[i].x), y(curve.points[i].low));
        }
        svg_.back() = '"';
        svg_ += " fill=\"" + std::string{style.colour} + "\" fill-opacity=\"0.18\"/>\n";
    }
    void curve(const Curve& curve, const Scale& x, const Scale& y, const Style& style, double stroke) {
        svg_ += "<polyline points=\"";
        for (const CurvePoint& point : curve.points) {
            at(x(point.x), y(point.y));
        }
        svg_.back() = '"';
        svg_ += " fill=\"none\" stroke-linejoin=\"round\"" + stroked(style.colour, stroke, style.dashes) + "/>\n";
    }
    std::string take(std::string_view title) && {
        return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
               number(width) + "\" height=\"" + number(height) + "\" viewBox=\"0 0 " + number(width) + " " +
               number(height) + "\" font-family=\"sans-serif\" fill=\"#222222\">\n<title>" + escaped(title) +
               "</title>\n<rect width=\"" + number(width) + "\" height=\"" + number(height) +
               "\" fill=\"#ffffff\"/>\n" + svg_ + "</svg>\n";
    }

  private:
    static std::string stroked(std::string_view colour, double stroke, std::string_view dashes) {
        return " stroke=\"" + std::string{colour} + "\" stroke-width=\"" + number(stroke) + "\"" +
               (dashes.empty() ? "" : " stroke-dasharray=\"" + std::string{dashes} + "\"");
    }
    void at(double x, double y) { svg_ += number(x) + "," + number(y) + " "; }

    std::string svg_;
};

} // namespace

std::vector<double> axis_ticks(double least, double greatest, std::size_t count_max) {
    EVOD_ASSERT(count_max >= 2);
    EVOD_ASSERT(least <= greatest);
    if (least == greatest) {
        return {least};
    }
    const double smallest = (greatest - least) / static_cast<double>(count_max - 1);
    const double power = std::pow(10, std::floor(std::log10(smallest)));
    double step = 10 * power;
    for (const double factor : {1.0, 2.0, 5.0}) {
        if (factor * power >= smallest * (1 - 1e-9)) {
            step = factor * power;
            break;
        }
    }
    std::vector<double> ticks;
    // A tick on the very end of the axis is one of it, however it was rounded.
    const double slack = step * 1e-9;
    for (double i = std::ceil((least - slack) / step); i * step <= greatest + slack; ++i) {
        ticks.push_back(i * step + 0.0); // which makes 0 of −0
    }
    return ticks;
}

std::string curves_picture(const CurvesText& text, std::span<const Curve> curves) {
    EVOD_ASSERT(!curves.empty());
    const auto& first = curves.front().points;
    EVOD_ASSERT(!first.empty());
    double x_least = first[0].x, x_greatest = x_least, y_least = first[0].low, y_greatest = first[0].high;
    for (const Curve& curve : curves) {
        for (const CurvePoint& point : curve.points) {
            x_least = std::min(x_least, point.x);
            x_greatest = std::max(x_greatest, point.x);
            y_least = std::min(y_least, point.low);
            y_greatest = std::max(y_greatest, point.high);
        }
    }
    const double room = (y_greatest - y_least) * 0.04;
    const Scale x = scale_of(x_least, x_greatest, left, right);
    const Scale y = scale_of(y_least - room, y_greatest + room, bottom, top);

    Picture picture;
    picture.words(left, 32, "start", 18, text.title, " font-weight=\"bold\"");
    picture.words(left, 54, "start", 13, text.subtitle);
    for (const double tick : axis_ticks(y.least, y.greatest, 9)) {
        picture.line(left, y(tick), right, y(tick), "#dddddd", 1);
        picture.words(left - 8, y(tick) + 4, "end", 12, tick_text(tick));
    }
    for (const double tick : axis_ticks(x.least, x.greatest, 9)) {
        picture.line(x(tick), bottom, x(tick), bottom + 5, "#222222", 1);
        picture.words(x(tick), bottom + 20, "middle", 12, tick_text(tick));
    }
    for (std::size_t i = curves.size(); i-- > 0;) {
        picture.band(curves[i], x, y, style_of(i));
    }
    for (std::size_t i = curves.size(); i-- > 0;) {
        picture.curve(curves[i], x, y, style_of(i), i == 0 ? 3 : 1.8);
    }
    picture.line(left, top, left, bottom, "#222222", 1);
    picture.line(left, bottom, right, bottom, "#222222", 1);
    picture.words((left + right) / 2, bottom + 44, "middle", 13, text.x_label);
    const std::string middle = number((top + bottom) / 2);
    picture.words(20, (top + bottom) / 2, "middle", 13, text.y_label, " transform=\"rotate(-90 20 " + middle + ")\"");
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const double at = top + 14 + legend_step * static_cast<double>(i);
        picture.line(legend_x, at - 4, legend_x + 26, at - 4, style_of(i).colour, i == 0 ? 3 : 1.8, style_of(i).dashes);
        picture.words(legend_x + 34, at, "start", 13, clipped(curves[i].name));
    }
    return std::move(picture).take(text.title);
}

} // namespace evod::commands
