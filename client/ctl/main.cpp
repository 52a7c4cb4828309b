// evoctl: sends one command to an evod server.
#include "client/ctl/caller.h"
#include "client/ctl/refusal.h"
#include "client/ctl/text.h"
#include "proto/command_line/completion.h"
#include "proto/command_line/exhaustion.h"
#include "proto/command_line/terminal.h"

#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <string>
#include <string_view>

using namespace evod::ctl;

namespace {

/// Other users of the machine can read a command line, so it must not contain a token.
void refuse_token(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
        const std::string_view word = argv[i];
        if (word == "--token" || word.starts_with("--token=")) {
            throw Stop{
                ExitCode::Usage,
                "--token: every user of the machine can read a command line; put the token into EVOD_TOKEN, or into a "
                "file for --token-file"};
        }
    }
}

/// Prints why the call failed: for people, or as a Status in JSON.
void report(const Stop& stop, const Common& common, const evod::command_line::Command& app) {
    if (common.json && !stop.text.empty()) {
        evod::v1::Status status = stop.status;
        if (status.message().empty()) {
            status.set_message(stop.text);
        }
        std::cerr << to_json(status, false);
        return;
    }
    const std::string text =
        stop.status.violations().empty() ? stop.text : refusal_text(stop.status, app.given_command());
    if (!text.empty()) {
        evod::command_line::print_error("evoctl", visible(text));
    }
}

} // namespace

int main(int argc, char** argv) {
    evod::command_line::end_when_exhausted("evoctl: out of memory or threads\n", static_cast<int>(ExitCode::Refused));
    Common common;
    evod::command_line::Command app{"evoctl", "evoctl: sends one command to an evod server", "evoctl " EVOD_VERSION};
    app.add_option("--world", &common.world,
                   "Name of the world; default: the server's only world, or the world 'default'")
        .environment("EVOD_WORLD");
    app.add_flag("--json", &common.json, "Print the reply as JSON; numbers from 2^53 on are strings");
    app.option_group("Connection");
    app.add_option("--server", &common.server, "HOST:PORT of the server").environment("EVOD_SERVER").show_default();
    app.add_option("--timeout", &common.timeout_s, "Seconds to wait for a reply")
        .show_default()
        .check(evod::command_line::RealNumber{0.001, 86400});
    add_options(app, common.credentials);
    app.accept_options_after_commands();
    app.footer("Examples:\n"
               "  evoctl run 50 --wait                  fifty generations\n"
               "  evoctl set selection=tournament       while it runs\n"
               "  evoctl --server lab:7744 watch        live, from another machine\n"
               "\n"
               "Exit status: 0 done, 1 refused by the server, 2 wrong usage or a value that is not allowed,\n"
               "3 no connection or no reply, 4 the server requires a valid token. With --json, standard error\n"
               "contains a Status in JSON.");
    add_run_commands(app, common);
    add_parameter_commands(app, common);
    add_place_commands(app, common);
    add_rate_command(app, common);
    add_query_commands(app, common);
    add_link_command(app, common);
    add_breeding_command(app, common);
    add_export_command(app, common);
    add_class_commands(app, common);
    add_note_command(app, common);
    add_watch_commands(app, common);
    add_top_command(app, common);
    add_help_commands(app);

    if (complete(app, argc, argv, values_of_server)) {
        return static_cast<int>(ExitCode::Ok);
    }
    use_colors(evod::command_line::may_color(STDOUT_FILENO));
    try {
        refuse_token(argc, argv);
        if (const auto ended = app.parse(argc, argv)) {
            return *ended;
        }
        if (const int status = app.run(); status != 0) {
            return status;
        }
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || !std::cout.flush()) {
            throw Stop{ExitCode::Refused, "standard output cannot be written: the disk may be full"};
        }
    } catch (const Stop& stop) {
        report(stop, common, app);
        return static_cast<int>(stop.code);
    }
    return static_cast<int>(ExitCode::Ok);
}
