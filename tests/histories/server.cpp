#include "tests/histories/server.h"

#include "tests/support/waiting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

namespace evod::histories {

using base::Result;

namespace {

constexpr std::uint32_t passes_max = 200'000; // until a history is given up

} // namespace

Result<std::unique_ptr<Server>> Server::open(const std::string& folder, const run_file::RunFile::Options& options,
                                             std::chrono::microseconds tick_takes, base::Executor& executor,
                                             simulation::IslandsMaker* maker) {
    auto archive = replay::Archive::open(folder, options, executor);
    if (!archive) {
        return archive.error();
    }
    return std::unique_ptr<Server>{new Server{*std::move(archive), tick_takes, executor, maker}};
}

Server::Server(std::unique_ptr<replay::Archive> archive, std::chrono::microseconds tick_takes, base::Executor& executor,
               simulation::IslandsMaker* maker)
    : archive_{std::move(archive)} {
    clock_.per_look = tick_takes;
    simulation::Laboratory laboratory = archive_->take_laboratory();
    if (maker != nullptr) {
        laboratory.share(*maker, executor);
    }
    loops_.emplace(
        executor, clock_, [this](runtime::Answer answer) { on_answer(std::move(answer)); },
        runtime::LoopOutputs{.events = [](auto&&...) {}, .snapshot = [](runtime::SnapshotPtr) {}},
        std::move(laboratory), &archive_->recorder());
    archive_->recorder().when_changed([this] { loops_->simulations.mailbox_of("").wake(); });
    loops_->live.poll_mailbox();
}

const simulation::Entry* Server::find(const std::string& name) const {
    return loops_->find(name);
}

void Server::on_answer(runtime::Answer answer) {
    if (auto* done = std::get_if<runtime::CommandDone>(&answer)) {
        answers_[done->mail.origin.request_id] = std::move(done->outcome);
    } else if (auto* shown = std::get_if<runtime::ReplayDone>(&answer)) {
        replay_ = std::move(shown->world);
    }
}

void Server::pass_once() {
    if (const auto next = loops_->pass()) {
        clock_.advance(std::max(*next - clock_.now(), runtime::Clock::duration{0}));
    } else {
        take_a_nap();
    }
}

void Server::send(const std::vector<SentCommand>& commands) {
    for (const SentCommand& sent : commands) {
        answers_[sent.request.request_id()] = std::nullopt;
        loops_->simulations.mailbox_of("").push(
            runtime::CommandMail{.command = sent.command,
                                 .origin = {.by = client,
                                            .client_key = sent.request.client_key(),
                                            .request_id = sent.request.request_id(),
                                            .request = sent.request.SerializeAsString()},
                                 .request_name = "command",
                                 .session = 1});
    }
}

void Server::pass(std::uint32_t count) {
    for (; count > 0; --count) {
        if (const auto next = loops_->pass()) {
            clock_.advance(std::max(*next - clock_.now(), runtime::Clock::duration{0}));
        }
    }
}

bool Server::is_answered() const {
    return std::ranges::all_of(answers_, [](const auto& answer) { return answer.second.has_value(); });
}

std::optional<std::string> Server::rest() {
    const auto rests = [this] {
        return is_answered() &&
               std::ranges::none_of(laboratory().entries(), [](const auto& entry) { return entry->wants_tick(); });
    };
    for (std::uint32_t passes = 0; !rests(); ++passes) {
        if (const auto trouble = archive_->recorder().trouble()) {
            return "the server cannot write: " + *trouble;
        }
        if (passes == passes_max) {
            return "the worlds run on and on";
        }
        pass_once();
    }
    return std::nullopt;
}

const Result<simulation::Applied>* Server::answer_to(std::uint64_t request_id) {
    const auto found = answers_.find(request_id);
    return found == answers_.end() || !found->second ? nullptr : &*found->second;
}

Result<base::StateHash> Server::replayed(const std::string& world, std::uint64_t tick) {
    const auto result_of = [&](auto request, const char* name) {
        replay_.reset();
        EXPECT_TRUE(loops_->simulations.try_send(
            runtime::ReplayMail{.request = std::move(request), .session = 1, .request_id = 1, .request_name = name}));
        while (!replay_) {
            pass_once();
        }
        return *replay_;
    };
    const auto shown = result_of(
        runtime::OpenReplay{.world = world, .at = replay::WantedMoment{.generation = {}, .tick = tick}}, "open_replay");
    if (!shown) {
        return shown.error();
    }
    const base::StateHash hash = find(*shown)->world.hash();
    (void)result_of(runtime::CloseReplay{*shown}, "close_replay");
    return hash;
}

void Server::write_all() {
    EXPECT_TRUE(wait_until([this] { return archive_->thread()->idle(); }));
}

bool Server::close() {
    loops_->live.close();
    archive_->recorder().when_changed({});
    return archive_->close();
}

} // namespace evod::histories
