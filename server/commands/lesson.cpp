// `evod lesson`: lists lessons, checks them, prints handouts, and collects the answers from run files.
#include "proto/command_line/command.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"
#include "server/commands/interrupt.h"
#include "server/experiments/lesson_check.h"
#include "server/experiments/lesson_texts.h"

#include <algorithm>
#include <filesystem>
#include <iostream>

namespace evod::commands {
namespace {

namespace fs = std::filesystem;

/// The folder of the lessons that evod brings: where they are installed, or in the source tree of a build. Empty: there
/// is none.
fs::path lesson_folder() {
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
    for (const fs::path& folder :
         {program / "../share/evod/experiments/lessons", program / "../../../experiments/lessons"}) {
        if (fs::is_directory(folder, error)) {
            return folder.lexically_normal();
        }
    }
    return {};
}

/// The path of a lesson: the file itself, or one that evod brings.
std::string lesson_path(const std::string& name, const std::string& language) {
    std::error_code error;
    if (fs::exists(name, error)) {
        return name;
    }
    const fs::path folder = language == "de" ? lesson_folder() / "de" : lesson_folder();
    return (folder / (name + ".json")).string();
}

int list() {
    std::error_code error;
    std::vector<fs::path> paths;
    for (const fs::directory_entry& entry : fs::directory_iterator{lesson_folder(), error}) {
        if (entry.path().extension() == ".json") {
            paths.push_back(entry.path());
        }
    }
    std::ranges::sort(paths);
    for (const fs::path& path : paths) {
        const auto lesson = experiments::load_lesson(path.string());
        if (!lesson) {
            return fail(lesson.error());
        }
        std::cout << path.stem().string() << ": " << lesson->title << " (" << lesson->minutes << " min)\n";
    }
    return paths.empty() ? fail("no lessons are installed") : 0;
}

struct CheckOptions {
    std::vector<std::string> files;
    std::uint32_t seeds = 20;
    std::size_t jobs = default_thread_count();
};

/// Prints one line for each check and guess. Returns the exit status.
int check(const CheckOptions& options) {
    catch_interrupts();
    bool is_refused = false;
    for (const std::string& file : options.files) {
        const auto lesson = experiments::load_lesson(lesson_path(file, "en"));
        if (!lesson) {
            return fail(lesson.error());
        }
        const auto report = experiments::check_lesson(*lesson, options.seeds, options.jobs, interrupted);
        if (!report) {
            return exit_interrupted;
        }
        std::cout << file << ": " << lesson->title << "\n";
        for (const experiments::CountedGuess& guess : report->guesses) {
            std::cout << (guess.is_refused ? "  REFUSED " : "  ") << (guess.of.empty() ? "all choices" : guess.of)
                      << ", " << guess.guess << ": " << guess.passed << " of " << guess.tried << "\n";
        }
        for (const std::string& observed : report->observed) {
            std::cout << "  observed " << observed << "\n";
        }
        is_refused |= report->is_refused();
    }
    return is_refused ? fail("a check fails too often, or a guess passes too often") : 0;
}

int handout(const std::string& name, const std::string& language) {
    const auto lesson = experiments::load_lesson(lesson_path(name, language));
    if (!lesson) {
        return fail(lesson.error());
    }
    std::cout << experiments::handout_of(*lesson, language);
    return 0;
}

int report(const std::vector<std::string>& files) {
    experiments::write_report_heading(std::cout);
    int status = 0;
    for (const std::string& file : files) {
        if (const auto written = experiments::write_report(file, std::cout); !written) {
            status = fail(written.error());
        }
    }
    return status;
}

} // namespace

void add_lesson_command(command_line::Command& app) {
    auto& lesson = app.add_command("lesson", "Check lessons, print handouts, and collect the answers of a class")
                       .group("Experiments");
    lesson.add_command("list", "List the lessons that evod brings").action(list);

    auto& checking = lesson.add_command("check", "Play lessons with many seeds, and count how often their checks pass");
    auto& options = checking.keep(CheckOptions{});
    checking.add_option("files", &options.files, "Lesson files (JSON), or names of lessons that evod brings")
        .count(1, 100);
    checking.add_option("--seeds", &options.seeds, "Number of seeds: the lesson's own one, and others")
        .check(command_line::WholeNumber{1, 10'000})
        .show_default();
    checking.add_option("--jobs", &options.jobs, "Number of seeds that are played at the same time")
        .check(thread_count)
        .show_default();
    checking.footer("Exit status: 0 good, 1 a check fails for more than one seed in ten, or a guess without thought "
                    "passes in more than six of ten, 130 interrupted.");
    checking.action([&] { return check(options); });

    auto& printing = lesson.add_command("handout", "Print a lesson as an HTML page with space for predictions");
    auto& name = printing.keep(std::string{});
    auto& language = printing.keep(std::string{"en"});
    printing.add_option("name", &name, "Name of a lesson that evod brings, or a lesson file").required();
    printing.add_option("--language", &language, "Language: en or de").choices({"en", "de"}).show_default();
    printing.action([&] { return handout(name, language); });

    auto& collecting = lesson.add_command(
        "report", "Print the predictions and answers in run files as CSV, one line for each prediction");
    auto& files = collecting.keep(std::vector<std::string>{});
    auto& csv = collecting.keep(true);
    collecting.add_option("files", &files, "Run files, NAME.evod").count(1, 10'000);
    collecting.add_flag("--csv", &csv, "Print CSV, which is the only format");
    collecting.action([&] { return report(files); });
}

} // namespace evod::commands
