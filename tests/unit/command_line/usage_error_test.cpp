#include "proto/command_line/usage_error.h"

#include "proto/command_line/command.h"

#include <gtest/gtest.h>

namespace evod::command_line {
namespace {

TEST(UsageError, NamesTheOptionAndWhatIsAllowed) {
    Command app{"lab", "lab: a laboratory", "lab 1.2"};
    std::string role, port, bind, data;
    bool nothing = false, fast = false;
    auto& add = app.add_command("add", "Adds.");
    add.add_option("--role", &role, "Role").required().choices({"viewer", "admin"});
    auto& serve = app.add_command("serve", "Serves.");
    const auto with_port = serve.add_option("--port", &port, "Port");
    serve.add_option("--bind", &bind, "Address").needs(with_port);
    const auto with_data = serve.add_option("--data", &data, "Folder");
    serve.add_flag("--keep-nothing", &nothing, "Nothing").excludes(with_data);
    serve.add_flag("--fast", &fast, "Fast");
    const std::pair<std::vector<const char*>, const char*> errors[] = {
        {{"add"}, "lab: --role: got nothing, allowed viewer|admin\nSee lab add --help\n"},
        {{"add", "--role", "king"}, "lab: --role: got king, allowed viewer, admin\nSee lab add --help\n"},
        {{"add", "--roel", "admin"}, "lab: --roel: unknown option; did you mean --role?\nSee lab add --help\n"},
        {{"serve", "--port"}, "lab: --port: got nothing, a value is required\nSee lab serve --help\n"},
        {{"serve", "--port", "1", "--port", "2"}, "lab: --port: got 2 values, allowed 1\nSee lab serve --help\n"},
        {{"serve", "--bind", "x"}, "lab: --bind: allowed only with --port\nSee lab serve --help\n"},
        {{"serve", "--keep-nothing", "--data", "x"},
         "lab: --data: not allowed with --keep-nothing\nSee lab serve --help\n"},
        {{"serve", "--fast=maybe"}, "lab: --fast: got maybe, allowed no value\nSee lab serve --help\n"},
        {{"serve", "more"}, "lab: more: unexpected argument\nSee lab serve --help\n"},
    };
    for (const auto& [words, error] : errors) {
        std::vector<const char*> line{"lab"};
        line.insert(line.end(), words.begin(), words.end());
        testing::internal::CaptureStderr();
        EXPECT_EQ(app.parse(static_cast<int>(line.size()), line.data()), exit_usage);
        EXPECT_EQ(testing::internal::GetCapturedStderr(), error);
    }
}

} // namespace
} // namespace evod::command_line
