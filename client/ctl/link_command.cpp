// link: prints the URL at which a browser shows a moment of a world.
#include "client/core/page_link.h"
#include "client/ctl/caller.h"
#include "proto/command_line/command.h"

#include <iostream>
#include <optional>
#include <string>

namespace evod::ctl {

namespace {

struct LinkOptions {
    std::optional<std::uint64_t> generation, tick;
    std::optional<std::uint32_t> island, organism;
    bool live = false;
    std::string page; // empty: the page of the server
};

std::string check_page(const std::string& word) {
    const bool is_url = word.starts_with("http://") || word.starts_with("https://");
    return is_url && core::fits_into_url(word)
               ? ""
               : "got " + word + ", allowed a URL without #, such as https://evod.example.org/";
}

/// Throws Stop if the server has not yet reached the moment.
void check_moment(const core::PageMoment& moment, const core::PageMoment& present, const v1::WorldInfo& world) {
    if (*moment.generation > *present.generation) {
        throw Stop{ExitCode::Usage, "--generation: got " + std::to_string(*moment.generation) + ", allowed 1 to " +
                                        std::to_string(*present.generation)};
    }
    if (moment.generation == present.generation && moment.tick > present.tick && !world.has_replay()) {
        throw Stop{ExitCode::Usage, "--tick: got " + std::to_string(moment.tick) + ", allowed 0 to " +
                                        std::to_string(present.tick) + " in generation " +
                                        std::to_string(*present.generation)};
    }
}

void link(const Common& common, const LinkOptions& options) {
    Caller caller{common};
    const v1::WorldInfo world = caller.world(common.world);
    std::string page = options.page.empty() ? caller.page() : options.page;
    if (page.empty()) {
        throw Stop{ExitCode::Refused, "this server has no page that this machine can reach: start it with --web and, "
                                      "for other machines, --http-bind; or give the page's address with --page"};
    }
    if (!core::fits_into_url(world.name()) || !core::fits_into_url(world.replay().replay_of())) {
        throw Stop{ExitCode::Refused, "the server reports a name of the world that a URL cannot contain"};
    }
    if (options.page.empty() && !caller.other_page_host().empty()) {
        std::cerr << "evoctl: the server reports that its page is at another host: " << caller.other_page_host()
                  << '\n';
    }
    page += page.ends_with('/') ? "" : "/";
    const core::PageMoment present = core::moment_of(world);
    core::PageMoment moment = present;
    if (options.live) {
        moment.generation.reset();
    } else if (options.generation) {
        moment.generation = options.generation;
        moment.tick = options.tick.value_or(0);
        check_moment(moment, present, world);
    }
    if (options.island && *options.island >= world.island_count()) {
        throw Stop{ExitCode::Usage, "--island: got " + std::to_string(*options.island) + ", allowed 0 to " +
                                        std::to_string(world.island_count() - 1)};
    }
    moment.island = options.island;
    moment.organism = options.organism;
    const std::string text = core::link_of(page, moment);
    std::cout << (common.json ? "{\"link\":\"" + text + "\"}" : text) << '\n'; // a URL needs no escapes
}

} // namespace

void add_link_command(command_line::Command& app, const Common& common) {
    auto& command = app.add_command("link", "Print a link that shows a moment of a world in a browser; default: the "
                                            "present moment")
                        .group("Look");
    auto& options = command.keep(LinkOptions{});
    const auto live = command.add_flag("--live", &options.live, "Link to the world as it runs, without a moment");
    const auto generation = command.add_option("--generation", &options.generation, "Generation of the moment")
                                .check(at_least_one)
                                .excludes(live);
    command
        .add_option("--tick", &options.tick, "Tick of the moment, counted from the start of --generation; default: 0")
        .check(whole_number)
        .needs(generation);
    command.add_option("--island", &options.island, "Island that the page shows, numbered from 0").check(index_number);
    command.add_option("--organism", &options.organism, "Organism that the page selects").check(index_number);
    command
        .add_option("--page", &options.page,
                    "Address of the page, for example of a proxy; default: the one that the server reports")
        .check(check_page);
    command.footer("Examples:\n  evoctl link\n  evoctl link --generation 12 --tick 600 --organism 7\n"
                   "  evoctl link --live");
    command.action([&] { link(common, options); });
}

} // namespace evod::ctl
