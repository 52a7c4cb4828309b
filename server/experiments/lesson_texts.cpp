#include "server/experiments/lesson_texts.h"

#include "evod/v1/commands.pb.h"
#include "proto/text/csv.h"
#include "server/parameters/json_text.h"
#include "server/run_file/run_file.h"

#include <algorithm>
#include <array>
#include <utility>

namespace evod::experiments {
namespace {

using parameters::JsonMember;
using parameters::JsonNode;

// ---- handouts --------------------------------------------------------------------------------------------------

/// The words of a handout that are not in the lesson.
struct Words {
    std::string_view name, date, minutes, goals, needs, predict, observed, law, run, generations, from, to;
};
constexpr Words english{"Name",          "Date",          "minutes",  "Goals",
                        "What you need", "My prediction", "Observed", "What theory says",
                        "Run the world", "generations",   "from",     "to"};
constexpr Words german{"Name",
                       "Datum",
                       "Minuten",
                       "Ziele",
                       "Was ihr braucht",
                       "Meine Vorhersage",
                       "Beobachtet",
                       "Was die Theorie sagt",
                       "Lass die Welt laufen",
                       "Generationen",
                       "von",
                       "bis"};

std::string escaped(std::string_view text) {
    std::string html;
    for (const char c : text) {
        html += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string{c};
    }
    return html;
}

/// Converts emphasis and code within a line.
std::string inline_html(std::string_view line) {
    std::string html = escaped(line);
    static constexpr std::pair<std::string_view, std::string_view> marks[] = {
        {"**", "strong"}, {"*", "em"}, {"`", "code"}};
    for (const auto& [mark, element] : marks) {
        for (std::size_t open = html.find(mark); open != std::string::npos; open = html.find(mark, open)) {
            const std::size_t close = html.find(mark, open + mark.size());
            if (close == std::string::npos) {
                break;
            }
            const std::string inner = html.substr(open + mark.size(), close - open - mark.size());
            std::string marked{"<"};
            marked.append(element).append(">").append(inner).append("</").append(element).append(">");
            html.replace(open, close + mark.size() - open, marked);
            open += marked.size();
        }
    }
    return html;
}

/// Converts the Markdown of docs/LESSONS.md, Texts.
std::string text_html(std::string_view text) {
    std::string html;
    bool in_list = false, in_paragraph = false;
    const auto close = [&] {
        html += in_list ? "</ul>\n" : in_paragraph ? "</p>\n" : "";
        in_list = in_paragraph = false;
    };
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const bool is_item = line.starts_with("- ");
        if (line.empty() || is_item != in_list) {
            close();
        }
        if (is_item) {
            html += (in_list ? "" : "<ul>\n") + ("<li>" + inline_html(line.substr(2))) + "</li>\n";
            in_list = true;
        } else if (!line.empty()) {
            html += (in_paragraph ? "\n" : "<p>") + inline_html(line);
            in_paragraph = true;
        }
    }
    close();
    return html;
}

/// Empty axes to draw a curve.
std::string axes_html(const Prediction& prediction) {
    constexpr int width = 480, height = 240, left = 60, grid = 10;
    std::string html = "<svg viewBox=\"0 0 560 300\" width=\"560\" role=\"img\">\n";
    for (int i = 0; i <= grid; ++i) {
        const std::string x = std::to_string(left + i * width / grid), y = std::to_string(10 + i * height / grid);
        html += "<path d=\"M" + x + " 10v240M60 " + y + "h480\" stroke=\"" + (i == 0 || i == grid ? "#000" : "#ccc") +
                "\" fill=\"none\"/>\n";
    }
    const auto label = [&](int x, int y, const char* anchor, const std::string& text) {
        html += "<text x=\"" + std::to_string(x) + "\" y=\"" + std::to_string(y) + "\" text-anchor=\"" + anchor +
                "\">" + escaped(text) + "</text>\n";
    };
    label(left, 270, "middle", text::number_text(prediction.x.min));
    label(left + width, 270, "middle", text::number_text(prediction.x.max));
    label(left + width / 2, 290, "middle", prediction.x.label);
    label(left - 6, 255, "end", text::number_text(prediction.y.min));
    label(left - 6, 18, "end", text::number_text(prediction.y.max));
    return html + "<text transform=\"translate(20 130) rotate(-90)\" text-anchor=\"middle\">" +
           escaped(prediction.y.label) + "</text>\n</svg>\n";
}

std::string prediction_html(const Prediction& prediction, const Words& words) {
    std::string html =
        "<div class=\"predict\"><p><b>" + escaped(prediction.ask) + "</b></p>\n<p>" + std::string{words.predict} + ": ";
    const std::string line = "<span class=\"line\"></span>";
    switch (prediction.kind) {
    case Prediction::Kind::Number:
        html += line + " " + escaped(prediction.unit) + " (" + std::string{words.from} + " " +
                text::number_text(prediction.min) + " " + std::string{words.to} + " " +
                text::number_text(prediction.max) + ")</p>\n";
        break;
    case Prediction::Kind::Choice:
    case Prediction::Kind::Order:
        html += "</p>\n";
        for (const std::string& option : prediction.options) {
            html += "<p><span class=\"box\"></span> " + escaped(option) + "</p>\n";
        }
        break;
    case Prediction::Kind::Curve:
        html += "</p>\n" + axes_html(prediction);
        break;
    case Prediction::Kind::Sentence:
        html += "</p>\n<p class=\"write\"></p><p class=\"write\"></p><p class=\"write\"></p>\n";
        break;
    }
    return html + "</div>\n";
}

// ---- reports ---------------------------------------------------------------------------------------------------

/// What the notes say about one prediction.
struct Row {
    std::string lesson, id, step;
    std::string predicted = {}, observed = {}, passed = {}, apart = {}, law = {}, error = {};
};

/// A JSON value as a cell. A spreadsheet must not compute a text that a pupil wrote.
std::string cell_of(const JsonNode* node) {
    if (node == nullptr || node->text == "null") {
        return {};
    }
    if (!node->is_string()) {
        return std::string{node->text};
    }
    const std::string text = node->string();
    const bool is_formula = !text.empty() && std::string_view{"=+-@\t\r"}.find(text[0]) != std::string_view::npos;
    return (is_formula ? "'" : "") + text;
}

void add_note(const std::string& kind, const std::string& text, std::vector<Row>& rows) {
    const bool is_prediction = kind == "lesson_prediction";
    if (!is_prediction && kind != "lesson_answer") {
        return;
    }
    const auto note = parameters::parse_json(text);
    if (!note || !note->is_object()) {
        return;
    }
    const auto cell = [&](std::string_view name) {
        const JsonMember* member = note->find(name);
        return cell_of(member == nullptr ? nullptr : &member->value);
    };
    const std::string lesson = cell("lesson"), id = cell("id");
    auto row = std::ranges::find_if(rows, [&](const Row& other) { return other.lesson == lesson && other.id == id; });
    if (row == rows.end()) {
        if (lesson.empty() || id.empty()) {
            return;
        }
        row = rows.insert(rows.end(), Row{.lesson = lesson, .id = id, .step = cell("step")});
    }
    if (is_prediction) {
        row->predicted = cell("value");
        return;
    }
    for (const auto& [name, field] : {std::pair{"observed", &Row::observed},
                                      {"passed", &Row::passed},
                                      {"apart", &Row::apart},
                                      {"law", &Row::law},
                                      {"error", &Row::error}}) {
        (*row).*field = cell(name);
    }
}

} // namespace

std::string handout_of(const Lesson& lesson, const std::string& language) {
    const Words& words = language == "de" ? german : english;
    std::string html = "<!DOCTYPE html>\n<html lang=\"" + language + "\">\n<head>\n<meta charset=\"utf-8\">\n<title>" +
                       escaped(lesson.title) +
                       "</title>\n<style>\n"
                       "body { font: 12pt/1.4 sans-serif; max-width: 18cm; margin: 1cm auto; }\n"
                       "section { break-inside: avoid; }\n"
                       ".predict { border: 1px solid #888; padding: 0 1em; margin: 1em 0; break-inside: avoid; }\n"
                       ".line { display: inline-block; width: 5cm; border-bottom: 1px solid #000; }\n"
                       ".box { display: inline-block; width: 1.2em; height: 1.2em; border: 1px solid #000; "
                       "vertical-align: middle; }\n"
                       ".write { border-bottom: 1px solid #000; height: 1.5em; margin: 0 0 .3em; }\n"
                       "svg { max-width: 100%; font-size: 10pt; }\n"
                       "</style>\n</head>\n<body>\n";
    const std::string line = "<span class=\"line\"></span>";
    html += "<p>" + std::string{words.name} + ": " + line + " " + std::string{words.date} + ": " + line + "</p>\n<h1>" +
            escaped(lesson.title) + "</h1>\n<p>" + std::to_string(lesson.minutes) + " " + std::string{words.minutes} +
            "</p>\n<h2>" + std::string{words.goals} + "</h2>\n<ul>\n";
    for (const std::string& goal : lesson.goals) {
        html += "<li>" + escaped(goal) + "</li>\n";
    }
    html += "</ul>\n<p><b>" + std::string{words.needs} + ":</b> " + escaped(lesson.needs) + "</p>\n";
    std::size_t number = 0;
    for (const LessonStep& step : lesson.steps) {
        html += "<section>\n<h2>" + std::to_string(++number) + ". " + escaped(step.title) + "</h2>\n" +
                text_html(step.text);
        if (step.predict) {
            html += prediction_html(*step.predict, words);
        }
        if (step.run > 0) {
            html += "<p>☐ " + std::string{words.run} + ": " + std::to_string(step.run) + " " +
                    std::string{words.generations} + "</p>\n";
        }
        if (step.check) {
            html += "<p>" + std::string{words.observed} + ": " + line + "</p>\n";
        }
        if (step.law) {
            html += "<p>" + std::string{words.law} + ": " + escaped(step.law->text) + "</p>\n";
        }
        html += "</section>\n";
    }
    return html + "</body>\n</html>\n";
}

void write_report_heading(std::ostream& out) {
    out << "file,world,run,lesson,step,id,predicted,observed,passed,apart,law,error\n";
}

base::Result<void> write_report(const std::string& path, std::ostream& out) {
    constexpr std::uint32_t entries_at_once = 1000;
    const auto file = run_file::RunFile::open_read_only(path);
    if (!file) {
        return file.error();
    }
    std::vector<Row> rows;
    for (std::uint64_t first = 1;;) {
        const auto entries = (*file)->journal().read(first, entries_at_once);
        if (!entries) {
            return entries.error();
        }
        if (entries->empty()) {
            break;
        }
        first += entries->size();
        for (const run_file::JournalEntry& entry : *entries) {
            v1::Request request;
            if (request.ParseFromString(entry.origin.request) && request.has_add_note()) {
                add_note(request.add_note().kind(), request.add_note().text(), rows);
            }
        }
    }
    const run_file::RunIdentity& identity = (*file)->identity();
    for (const Row& row : rows) {
        const std::string cells[] = {path,          identity.name, to_text(identity.run_id),
                                     row.lesson,    row.step,      row.id,
                                     row.predicted, row.observed,  row.passed,
                                     row.apart,     row.law,       row.error};
        const char* separator = "";
        for (const std::string& cell : cells) {
            out << std::exchange(separator, ",") << text::csv_cell(cell);
        }
        out << "\n";
    }
    return {};
}

} // namespace evod::experiments
