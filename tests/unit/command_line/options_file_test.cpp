#include "proto/command_line/options_file.h"

#include "proto/command_line/command.h"
#include "proto/command_line/number.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

namespace evod::command_line {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A program with an options file, in a folder of its own.
struct ProgramWithFile {
    Command app{"lab", "A laboratory.", "lab 1.2"};
    std::uint16_t port = 1;
    bool web = false, quiet = false;
    std::string level = "info";
    std::vector<std::string> hosts;
    std::filesystem::path folder;

    ProgramWithFile() {
        std::string name = (std::filesystem::temp_directory_path() / "evod-XXXXXX").string();
        folder = ::mkdtemp(name.data());
        app.add_options_file("--config", "File");
        app.add_option("--port", &port, "Port").check(WholeNumber{0, 65535});
        const auto web_given = app.add_flag("--web", &web, "Web");
        app.add_option("--host", &hosts, "Host").one_at_a_time().check([web_given](const std::string&) {
            return web_given.is_given() ? std::string{} : std::string{"requires --web"};
        });
        const auto leveled = app.add_option("--level", &level, "Level").choices({"info", "debug"});
        app.add_flag("--quiet", &quiet, "Quiet").excludes(leveled);
        app.add_command("run", "Runs.").action([] {});
        app.action([] {});
    }
    ~ProgramWithFile() { std::filesystem::remove_all(folder); }

    std::string write(std::string_view text) const {
        const std::string path = (folder / "conf").string();
        std::ofstream{path, std::ios::binary} << text;
        return path;
    }
    /// Returns the errors, each without the path of the file.
    std::vector<std::string> read(std::string_view text, std::vector<std::string> words = {}) {
        const std::string path = write(text);
        words.push_back("--config=" + path);
        std::vector<std::string> errors = app.read(words);
        for (std::string& error : errors) {
            error = error.starts_with(path) ? error.substr(path.size() + 1) : error;
        }
        return errors;
    }
};

TEST(OptionsFile, OptionsAreRead) {
    ProgramWithFile program;
    EXPECT_THAT(program.read("# The laboratory\n\n  port=7  # one\nweb\nhost = a#b\nhost\t= c d \nlevel = debug"),
                IsEmpty());
    EXPECT_EQ(program.port, 7);
    EXPECT_TRUE(program.web);
    EXPECT_THAT(program.hosts, ElementsAre("a#b", "c d"));
    EXPECT_EQ(program.level, "debug");
    EXPECT_THAT(program.read(""), IsEmpty());
}

TEST(OptionsFile, FilesOfWindowsAreRead) {
    ProgramWithFile program;
    EXPECT_THAT(program.read("\xef\xbb\xbfport = 7\r\nweb\r\n"), IsEmpty());
    EXPECT_EQ(program.port, 7);
    EXPECT_TRUE(program.web);
}

TEST(OptionsFile, TheCommandLineWins) {
    ProgramWithFile program;
    EXPECT_THAT(program.read("port = 7\nweb\nhost = a\nhost = b\nlevel = debug\n", {"--port", "8", "--host", "c"}),
                IsEmpty());
    EXPECT_EQ(program.port, 8);
    EXPECT_THAT(program.hosts, ElementsAre("c"));
    EXPECT_EQ(program.level, "debug");
}

TEST(OptionsFile, TheCommandLineExcludesLinesOfTheFile) {
    ProgramWithFile program;
    EXPECT_THAT(program.read("level = debug\n", {"--quiet"}), IsEmpty());
    EXPECT_EQ(program.level, "info");
}

TEST(OptionsFile, AnOptionMayNeedOneOfTheFile) {
    ProgramWithFile program;
    EXPECT_THAT(program.read("web\n", {"--host", "a"}), IsEmpty());
    EXPECT_THAT(program.read("port = 3\n", {"--host", "a"}), ElementsAre("--host: requires --web"));
    EXPECT_THAT(program.read("host = a\n", {"--web"}), IsEmpty());
}

TEST(OptionsFile, EveryMistakeIsReportedWithItsLine) {
    ProgramWithFile program;
    EXPECT_THAT(
        program.read("prot = 1\nport = 70000\nport = 3\nweb = yes\nlevel\nlevel = \nhost = a\nconfig = x\nhelp\n"
                     "version\n--port = 3\nport 7\n= 3\n"),
        ElementsAre("1: prot: unknown option; did you mean port?",
                    "2: port: got 70000, allowed a whole number, 0 to 65535", "3: port: given twice, first in line 2",
                    "4: web: got yes, allowed no value", "5: level: got nothing, allowed info|debug",
                    "6: level: got nothing, allowed info|debug", "7: host: requires --web",
                    "8: config: not allowed in a file", "9: help: not allowed in a file",
                    "10: version: not allowed in a file", "11: --port: unknown option; did you mean port?",
                    "12: port: got 7 without =, allowed port = 7", "13: =: unknown option"));
    EXPECT_THAT(program.read("web\nweb\nlevel = debug\nquiet\n"),
                ElementsAre("2: web: given twice, first in line 1", "4: quiet: not allowed with level in line 3"));
}

TEST(OptionsFile, LinesThatAreNotTextAreRefused) {
    ProgramWithFile program;
    EXPECT_THAT(
        program.read("port = \xff\n" + std::string(5000, 'x') + "\nlevel = a\x1b[31m\n" + std::string{"web\0", 4}),
        ElementsAre(HasSubstr("1: the line contains a control character, or bytes that are not UTF-8"),
                    "2: got a line of 5000 bytes, allowed 4096", HasSubstr("3: the line"), HasSubstr("4: the line")));
    std::string many;
    for (int i = 0; i < 150; ++i) {
        many += "x\n";
    }
    EXPECT_EQ(program.read(many).size(), 101u);
    EXPECT_THAT(program.read(many).back(), HasSubstr("50 more errors"));
}

TEST(OptionsFile, FilesThatCannotBeReadAreNamed) {
    ProgramWithFile program;
    EXPECT_THAT(program.app.read({"--config=/nowhere/conf"}), ElementsAre(HasSubstr("/nowhere/conf: ")));
    EXPECT_THAT(program.app.read({"--config=" + program.folder.string()}), ElementsAre(HasSubstr("this is a folder")));
    EXPECT_THAT(program.read(std::string((1 << 20) + 1, '\n')), ElementsAre(HasSubstr("too large")));
}

TEST(OptionsFile, IsNotReadForASubcommand) {
    ProgramWithFile program;
    EXPECT_THAT(program.read("port = 70000\n", {"run"}), ElementsAre(HasSubstr("--config")));
}

TEST(OptionsFile, RandomBytesAreHarmless) {
    ProgramWithFile program;
    std::mt19937 random{7};
    const std::vector<std::string> pieces{"port",
                                          "web",
                                          "host",
                                          "level",
                                          "quiet",
                                          "=",
                                          " ",
                                          "\n",
                                          "\r",
                                          "#",
                                          "7",
                                          "[1,2]",
                                          "\"",
                                          "{}",
                                          "\xc3\xa9",
                                          "\xff",
                                          "--",
                                          ",",
                                          "debug",
                                          "\t",
                                          "config",
                                          "%%",
                                          std::string(1, '\0')};
    for (int i = 0; i < 300; ++i) {
        std::string text;
        for (auto left = random() % 30; left > 0; --left) {
            text += pieces[random() % pieces.size()];
        }
        for (const std::string& error : program.read(text)) {
            EXPECT_TRUE(std::isdigit(static_cast<unsigned char>(error.front()))) << error;
        }
    }
}

} // namespace
} // namespace evod::command_line
