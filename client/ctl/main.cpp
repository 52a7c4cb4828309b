// evoctl: sends one command to an evod server.
#include "client/ctl/caller.h"
#include "client/ctl/text.h"
#include "proto/command_line/command.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <string>
#include <vector>

using namespace evod::ctl;

namespace {

/// Checks the name of the subcommand before the options, so that a misspelled name is reported as an unknown command.
void require_known_command(const evod::command_line::Command& app, int argc, char** argv) {
    std::vector<std::string> names;
    for (const auto& command : app.commands()) {
        names.push_back(command.name());
    }
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--server" || word == "--world" || word == "--timeout" || word == "--token-file" ||
            word == "--ca" || word == "--cert" || word == "--key") {
            ++i; // skips the value of the option
        } else if (word == "--token" || word.starts_with("--token=")) {
            throw Stop{
                ExitCode::Usage,
                "--token: every user of the machine can read a command line; put the token into EVOD_TOKEN, or into a "
                "file for --token-file"};
        } else if (!word.starts_with('-')) {
            if (std::ranges::find(names, word) == names.end()) {
                throw Stop{ExitCode::Usage,
                           "there is no command '" + word + "'" + did_you_mean(word, names) + "\nSee evoctl --help"};
            }
            return;
        }
    }
}

} // namespace

int main(int argc, char** argv) {
    Common common;
    evod::command_line::Command app{"evoctl", "evoctl: sends one command to an evod server", "evoctl " EVOD_VERSION};
    app.add_option("--server", &common.server, "HOST:PORT of the server").environment("EVOD_SERVER").show_default();
    add_options(app, common.credentials);
    app.add_option("--world", &common.world,
                   "Name of the world; default: the server's only world, or the world 'default'")
        .environment("EVOD_WORLD");
    app.add_option("--timeout", &common.timeout_s, "Seconds to wait for a reply")
        .show_default()
        .check(evod::command_line::RealNumber{0.001, 86400});
    app.add_flag("--json", &common.json, "Print the reply as JSON; numbers from 2^53 on are strings");
    app.accept_options_after_commands();
    app.help_column(32);
    app.footer("Examples:\n"
               "  evoctl run 50 --wait                  fifty generations\n"
               "  evoctl set selection=tournament       while it runs\n"
               "  evoctl --server lab:7744 watch        live, from another machine\n"
               "\n"
               "Exit codes: 0 done, 1 refused by the server, 2 wrong usage or a value that is not allowed,\n"
               "3 no connection or no reply, 4 the server requires a valid token. With --json, standard error "
               "contains a Status in JSON.");
    add_run_commands(app, common);
    add_parameter_commands(app, common);
    add_query_commands(app, common);
    add_breeding_command(app, common);
    add_export_command(app, common);
    add_watch_commands(app, common);
    add_top_command(app, common);
    add_complete_command(app);

    if (argc > 2 && std::strcmp(argv[1], "complete") == 0 && std::strcmp(argv[2], "--") == 0) {
        complete(app, {argv + 3, argv + argc});
        return static_cast<int>(ExitCode::Ok);
    }
    try {
        require_known_command(app, argc, argv);
        if (const auto ended = app.parse(argc, argv)) {
            return *ended;
        }
        app.run();
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || !std::cout.flush()) {
            throw Stop{ExitCode::Refused, "standard output cannot be written: the disk may be full"};
        }
    } catch (const Stop& stop) {
        if (!stop.text.empty() && common.json) {
            evod::v1::Status status = stop.status;
            if (status.message().empty()) {
                status.set_message(stop.text);
            }
            std::cerr << to_json(status, false);
        } else if (!stop.text.empty()) {
            std::cerr << "evoctl: " << visible(stop.text) << '\n';
        }
        return static_cast<int>(stop.code);
    }
    return static_cast<int>(ExitCode::Ok);
}
