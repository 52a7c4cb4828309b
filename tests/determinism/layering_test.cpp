// Layering: the arrows between folders, read from the #include lines, and what the core may not use.
//
// Covered      every .h and .cpp below server/, client/, proto/ and tests/ for includes of ours; server/{base, physics,
//              evolution, simulation} for headers and calls that would make a run depend on time, disk, threads, a
//              device or the C library's last bits; server/{protocol, run_file, recording,
//              replay} for sockets.
// Not covered  what a header of a library does inside; python and scripts.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace evod {
namespace {

namespace fs = std::filesystem;

const fs::path root = EVOD_SOURCE_FOLDER;

struct Source {
    std::string path;                         // from the root
    std::string folder;                       // of the table below
    std::vector<std::string> ours, libraries; // included, as written
    std::string code;                         // without comments
};

// Folder → the folders it may include, its own aside. A folder has an arrow only to folders printed below it in
// ARCHITECTURE.md; the core has none to proto.
const std::map<std::string, std::set<std::string>> arrows = {
    {"server/base", {}},
    {"server/physics", {"server/base"}},
    {"server/evolution", {"server/base"}},
    {"server/parameters", {"server/evolution", "server/base"}},
    {"server/simulation", {"server/parameters", "server/evolution", "server/physics", "server/base"}},
    {"server/protocol",
     {"server/simulation", "server/parameters", "server/evolution", "server/base", "proto/codec", "proto/evod"}},
    {"server/files", {"server/base"}},
    {"server/access", {"server/files", "server/base", "proto/evod"}},
    {"server/log", {}},
    {"server/metrics", {"proto/evod"}},
    {"server/run_file", {"server/files", "server/simulation", "server/parameters", "server/evolution", "server/base"}},
    {"server/recording",
     {"server/jobs", "server/run_file", "server/metrics", "server/log", "server/simulation", "server/parameters",
      "server/evolution", "server/base"}},
    {"server/replay",
     {"server/recording", "server/run_file", "server/protocol", "server/log", "server/simulation", "server/parameters",
      "server/evolution", "server/base", "proto/evod"}},
    {"server/runtime",
     {"server/jobs", "server/replay", "server/recording", "server/run_file", "server/protocol", "server/metrics",
      "server/log", "server/simulation", "server/parameters", "server/evolution", "server/physics", "server/base",
      "proto/codec", "proto/evod", "tests/support"}}, // the tsan preset's worker pool is that of tests/support
    {"server/experiments",
     {"server/replay", "server/recording", "server/run_file", "server/protocol", "server/files", "server/simulation",
      "server/parameters", "server/evolution", "server/physics", "server/base", "proto/codec", "proto/evod"}},
    {"server/commands",
     {"server/experiments", "server/network", "server/access", "server/log", "server/runtime", "server/replay",
      "server/recording", "server/run_file", "server/protocol", "server/simulation", "server/parameters",
      "server/evolution", "server/base", "proto/command_line", "proto/codec", "proto/evod"}},
    {"server/streaming",
     {"server/runtime", "server/protocol", "server/metrics", "server/simulation", "server/parameters", "server/physics",
      "server/base", "proto/codec", "proto/evod"}},
    {"server/network",
     {"server/jobs", "server/access", "server/streaming", "server/runtime", "server/replay", "server/recording",
      "server/run_file", "server/protocol", "server/metrics", "server/log", "server/simulation", "server/parameters",
      "server/evolution", "server/base", "proto/codec", "proto/evod"}},
    {"server", // main.cpp knows everyone
     {"server/network", "server/commands", "server/experiments", "server/access", "server/log", "server/runtime",
      "server/replay", "server/recording", "server/run_file", "server/protocol", "server/simulation",
      "server/parameters", "server/evolution", "server/physics", "server/base", "proto/command_line", "proto/codec",
      "proto/evod"}},
    {"proto/command_line", {}},
    {"proto/codec", {"proto/evod"}},
    {"client/core", {"proto/command_line", "proto/codec", "proto/evod"}},
    {"client/ctl", {"client/core", "proto/command_line", "proto/codec", "proto/evod"}},
    {"client/viewer/text", {}},
    {"client/viewer/drawing", {"client/viewer/text"}},
    {"client/viewer/world", {"client/viewer/text", "client/core", "proto/codec", "proto/evod"}},
    {"client/viewer/island",
     {"client/viewer/world", "client/viewer/drawing", "client/viewer/text", "client/core", "proto/codec",
      "proto/evod"}},
    {"client/viewer/panels",
     {"client/viewer/island", "client/viewer/world", "client/viewer/drawing", "client/viewer/text", "client/core",
      "proto/codec", "proto/evod"}},
    {"client/viewer/panes",
     {"client/viewer/panels", "client/viewer/island", "client/viewer/world", "client/viewer/drawing",
      "client/viewer/text", "client/core", "proto/codec", "proto/evod"}},
    {"client/viewer/shell",
     {"client/viewer/panes", "client/viewer/panels", "client/viewer/island", "client/viewer/world",
      "client/viewer/drawing", "client/viewer/text", "client/core", "proto/command_line", "proto/codec", "proto/evod"}},
};

std::string without_comments(const std::string& text) {
    std::string code;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text.compare(i, 2, "//") == 0) {
            i = std::min(text.find('\n', i), text.size());
            code += '\n';
        } else if (text.compare(i, 2, "/*") == 0) {
            i = std::min(text.find("*/", i), text.size() - 2) + 1;
        } else {
            code += text[i];
        }
    }
    return code;
}

/// The longest folder of the table that a path begins with; empty for none.
std::string folder_of(const std::string& path) {
    if (path.starts_with("evod/v1/")) {
        return "proto/evod"; // made by protoc
    }
    if (path.starts_with("tests/support/")) {
        return "tests/support";
    }
    if (path.starts_with("server/") && path.find('/', 7) == std::string::npos) {
        return "server";
    }
    for (const auto& [folder, allowed] : arrows) {
        if (folder != "server" && path.starts_with(folder + "/")) {
            return folder;
        }
    }
    return "";
}

const std::vector<Source>& sources() {
    static const std::vector<Source> all = [] {
        static const std::regex include{R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])"};
        std::vector<Source> found;
        for (const char* top : {"server", "client", "proto", "tests"}) {
            for (const fs::directory_entry& entry : fs::recursive_directory_iterator{root / top}) {
                const std::string extension = entry.path().extension().string();
                if (!entry.is_regular_file() || (extension != ".h" && extension != ".cpp")) {
                    continue;
                }
                std::ifstream file{entry.path()};
                std::stringstream text;
                text << file.rdbuf();
                Source source;
                source.path = fs::relative(entry.path(), root).generic_string();
                source.folder = folder_of(source.path);
                source.code = without_comments(text.str());
                std::istringstream lines{source.code};
                for (std::string line; std::getline(lines, line);) {
                    if (std::smatch match; std::regex_search(line, match, include)) {
                        (match[1] == "\"" ? source.ours : source.libraries).push_back(match[2]);
                    }
                }
                found.push_back(std::move(source));
            }
        }
        return found;
    }();
    return all;
}

bool is_core(const Source& source) {
    return source.folder == "server/base" || source.folder == "server/physics" || source.folder == "server/evolution" ||
           source.folder == "server/parameters" || source.folder == "server/simulation";
}

TEST(Layering, FindsTheSources) {
    EXPECT_GT(sources().size(), 80u);
    EXPECT_GT(std::count_if(sources().begin(), sources().end(), is_core), 50);
}

TEST(Layering, KnowsEveryFolderOfServerAndClient) {
    for (const Source& source : sources()) {
        EXPECT_FALSE(source.folder.empty() && !source.path.starts_with("tests/"))
            << source.path << " is in a folder that has no arrows yet";
    }
}

TEST(Layering, EveryIncludeFollowsAnArrow) {
    for (const Source& source : sources()) {
        if (source.path.starts_with("tests/") || source.folder.empty()) {
            continue;
        }
        for (const std::string& include : source.ours) {
            const std::string target = folder_of(include);
            EXPECT_TRUE(target == source.folder || arrows.at(source.folder).contains(target))
                << source.path << " includes " << include;
        }
    }
}

TEST(Layering, ArrowsGoNeverRound) {
    for (const auto& [folder, allowed] : arrows) {
        for (const std::string& target : allowed) {
            EXPECT_FALSE(arrows.contains(target) && arrows.at(target).contains(folder)) << folder << " and " << target;
        }
    }
}

TEST(Layering, ServerNeverIncludesTestsButTheWorkerPoolOfTsan) {
    for (const Source& source : sources()) {
        if (source.path.starts_with("server/") || source.path.starts_with("client/")) {
            for (const std::string& include : source.ours) {
                EXPECT_TRUE(!include.starts_with("tests/") || include == "tests/support/thread_executor.h")
                    << source.path << " includes " << include;
            }
        }
    }
}

TEST(Core, IncludesNothingThatHasATimeADiskAThreadOrADevice) {
    static const std::set<std::string> forbidden =
        {"thread",    "chrono",    "fstream",    "iostream",      "random",       "mutex",
         "future",    "atomic",    "stop_token", "shared_mutex",  "filesystem",   "condition_variable",
         "ctime",     "time.h",    "unistd.h",   "semaphore",     "barrier",      "latch",
         "coroutine", "execution", "regex",      "unordered_map", "unordered_set"}; // the last two: their order is the
                                                                                    // library's
    static const std::vector<std::string> forbidden_beginnings = {"google/", "evod/",   "boost/asio", "boost/beast",
                                                                  "sys/",    "spdlog/", "fmt/",       "tbb/",
                                                                  "oneapi/", "sqlite",  "zstd",       "proto/"};
    for (const Source& source : sources()) {
        if (!is_core(source)) {
            continue;
        }
        for (const std::string& include : source.libraries) {
            if (include == "atomic" && source.path == "server/base/commutative.h") {
                continue; // whose order of arrival cannot be told from the outcome
            }
            if (include == "sys/mman.h" && source.path == "server/base/column.cpp") {
                continue; // advice on memory, which changes nothing but how long it takes
            }
            EXPECT_FALSE(forbidden.contains(include)) << source.path << " includes <" << include << ">";
            for (const std::string& beginning : forbidden_beginnings) {
                EXPECT_FALSE(include.starts_with(beginning)) << source.path << " includes <" << include << ">";
            }
        }
    }
}

void expect_nowhere_in_core(const std::regex& pattern, const char* why) {
    for (const Source& source : sources()) {
        if (!is_core(source)) {
            continue;
        }
        std::istringstream lines{source.code};
        std::size_t number = 0;
        for (std::string line; std::getline(lines, line);) {
            ++number;
            EXPECT_FALSE(std::regex_search(line, pattern)) << source.path << ":" << number << ": " << why << line;
        }
    }
}

TEST(Core, CallsNoTranscendentalFunctionOfTheCLibrary) {
    // √, floor, ceil, abs, lrint and round are exact; every other function of <cmath> differs between processors.
    expect_nowhere_in_core(
        std::regex{
            R"((std::|[^\w:.]::)(sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|asinh|acosh|atanh|exp|exp2|expm1)"
            R"(|log|log2|log10|log1p|pow|hypot|cbrt|erf|erfc|tgamma|lgamma|fma|remainder|lerp|midpoint)f?l?\s*\()"},
        "a function with last bits of its own: ");
}

TEST(Core, UsesNoDistributionOrDeviceOfTheStandardLibrary) {
    expect_nowhere_in_core(
        std::regex{R"(std::(random_device|\w+_distribution|mt19937\w*|shuffle|sample|rand|time|clock)\b)"},
        "randomness or time that is not ours: ");
    expect_nowhere_in_core(std::regex{R"(\b(rdtsc|getenv|_mm_rsqrt|_mm_rcp|rsqrt)\b)"}, "not the same everywhere: ");
}

TEST(Core, ReducesNothingWithEigen) {
    // The order of such a sum depends on the width of a register.
    expect_nowhere_in_core(
        std::regex{
            R"((\.|->)(sum|dot|norm|squaredNorm|stableNorm|mean|prod|trace|normalized|normalize|redux|rsqrt)\s*\()"},
        "a reduction in Eigen's order: ");
}

TEST(Core, AsksNoReductionOfTheStandardLibraryForFloats) {
    expect_nowhere_in_core(std::regex{R"(std::(reduce|transform_reduce|inclusive_scan|exclusive_scan)\b)"},
                           "a sum in no stated order: ");
}

TEST(ProtocolAndRunFiles, OpenNoSockets) {
    for (const Source& source : sources()) {
        if (source.folder == "server/protocol" || source.folder == "server/run_file" ||
            source.folder == "server/recording" || source.folder == "server/replay" || source.folder == "proto/codec") {
            for (const std::string& include : source.libraries) {
                EXPECT_FALSE(include.starts_with("boost/asio") || include.starts_with("boost/beast") ||
                             include.starts_with("sys/socket"))
                    << source.path << " includes <" << include << ">";
            }
        }
    }
}

} // namespace
} // namespace evod
