#include "client/viewer/world/world_commands.h"

#include <string>
#include <utility>

namespace evod::viewer {

void WorldCommands::send(std::optional<evod::v1::Request> request) {
    if (!request) {
        return;
    }
    if (request->has_get_statistics()) {
        return feed_.request_statistics(request->get_statistics().world());
    }
    server_.send(*std::move(request), [this](const core::Result<evod::v1::Response>& response) {
        server_.report_if_refused(response);
        send(feed_.control().answered(response ? &*response : nullptr));
    });
}

/// Creates and sends a request if the session's role allows commands. RunControl assumes the effect of a request as
/// soon as it creates the request, so a forbidden request must not be created.
template <class MakeRequest>
void WorldCommands::command(MakeRequest make_request) {
    if (may_command()) {
        send(make_request());
    } else {
        server_.notice(std::string{read_only_text});
    }
}

/// Returns whether the run or the replay has ended. If so, adds a notice that suggests what to do.
bool WorldCommands::is_over() {
    const bool over = feed_.control().state() == evod::v1::RUN_STATE_TERMINATED || replay_.at_end();
    if (over) {
        server_.notice(feed_.replay() ? "This is the end of the replay; [ goes back by a generation"
                                      : "The run has ended; resetting the world starts it again");
    }
    return over;
}

void WorldCommands::pause_or_resume() {
    if (!is_over()) {
        command([this] { return feed_.control().pause_or_resume(); });
    }
}

void WorldCommands::step(std::uint64_t ticks) {
    if (!is_over()) {
        command([&] { return feed_.control().step(ticks); });
    }
}

void WorldCommands::run_generations(std::uint64_t generations) {
    if (!is_over()) {
        command([&] { return feed_.control().run_generations(generations); });
    }
}

void WorldCommands::faster() {
    command([this] { return feed_.control().faster(); });
}

void WorldCommands::slower() {
    command([this] { return feed_.control().slower(); });
}

void WorldCommands::real_time() {
    command([this] { return feed_.control().real_time(); });
}

void WorldCommands::max_speed() {
    command([this] { return feed_.control().max_speed(); });
}

void WorldCommands::at_factor(double factor) {
    command([&] { return feed_.control().at_factor(factor); });
}

void WorldCommands::reset(std::optional<std::uint64_t> seed) {
    command([&] { return feed_.control().reset(seed); });
}

} // namespace evod::viewer
