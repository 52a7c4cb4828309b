#include "tests/histories/history.h"

#include "server/base/overloaded.h"
#include "server/protocol/commands.h"
#include "server/replay/run_file_fork.h"
#include "server/replay/run_tables.h"
#include "server/replay/verify.h"
#include "tests/support/shared_worlds.h"

#include <filesystem>
#include <sstream>
#include <utility>

namespace evod::histories {

namespace {

namespace fs = std::filesystem;
using simulation::Entry;

constexpr std::uint32_t actions_per_history = 40;
constexpr std::size_t action_characters_max = 600;

std::chrono::microseconds random_tick_time(Draws& draws) {
    constexpr std::chrono::microseconds times[] = {std::chrono::microseconds{20}, std::chrono::milliseconds{1},
                                                   std::chrono::milliseconds{50}};
    return draws.one_of(times);
}

run_file::RunFile::Options random_options(Draws& draws) {
    run_file::RunFile::Options options{.durability = run_file::Durability::Relaxed};
    options.keep_every = draws.chance(0.5) ? 1 : draws.count(2, 3);
    return options;
}

std::string text_of(const base::Result<simulation::Applied>& applied) {
    if (!applied) {
        return "refused: " + base::to_text(applied.error());
    }
    std::string text = "accepted by " + applied->world + " at tick " + std::to_string(applied->tick);
    if (applied->planned) {
        text += ", planned change " + std::to_string(applied->planned->id);
    }
    for (const auto& ids : {applied->placed, applied->removed}) {
        for (const auto& list :
             ids ? std::vector{ids->food, ids->poison, ids->organisms} : std::vector<std::vector<std::uint32_t>>{}) {
            for (const std::uint32_t id : list) {
                text += " " + std::to_string(id);
            }
            text += ";";
        }
    }
    return text;
}

std::string shortened(std::string text) {
    if (text.size() > action_characters_max) {
        text.replace(action_characters_max, std::string::npos, " …");
    }
    return text;
}

} // namespace

History::History(std::uint64_t seed)
    : draws_{seed}
    , commands_{draws_}
    , options_{random_options(draws_)}
    , tick_takes_{random_tick_time(draws_)}
    , actions_left_{actions_per_history} {
    note("keep every " + std::to_string(options_.keep_every) + ", a look at the clock takes " +
         std::to_string(tick_takes_.count()) + " µs");
}

std::optional<std::string> History::play() {
    bool ended = false;
    while (!failure_ && !ended) {
        ended = actions_left_ == 0; // the last life only compares
        const std::uint32_t processes = draws_.chance(0.6) ? 0 : draws_.count(1, 4);
        if (processes == 0) {
            note("a server starts");
            base::InlineExecutor executor;
            live(executor, nullptr);
        } else {
            note("a server starts that shares its worlds among " + std::to_string(processes) + " processes");
            support::share_worlds(processes, 1, [this](simulation::IslandsMaker& maker, base::Executor& executor) {
                live(executor, &maker);
            });
        }
    }
    return failure_;
}

void History::live(base::Executor& executor, simulation::IslandsMaker* maker) {
    auto opened = Server::open(folder(), options_, tick_takes_, executor, maker);
    if (!opened) {
        return fail("the server does not start: " + to_text(opened.error()));
    }
    server_ = *std::move(opened);
    settle();
    compare(Depth::Whole, executor);
    if (actions_left_ == 0) {
        for (const auto& entry : twins_.laboratory().entries()) {
            if (!failure_) {
                apply({commands_.until(*entry, entry->world.moment().tick + 40)});
            }
        }
        compare(Depth::Whole, executor);
    }
    while (!failure_ && actions_left_ > 0 && !draws_.chance(0.12)) {
        --actions_left_;
        act();
        compare(Depth::Moment, executor);
    }
    if (!failure_) {
        stop(executor);
    }
    server_.reset(); // the leader outlives its worlds
}

void History::act() {
    if (!twins_.laboratory().entries().empty() && draws_.chance(0.08)) {
        return look_back();
    }
    apply(commands_.next(twins_));
}

const Entry& History::any_twin() {
    return *draws_.one_of(twins_.laboratory().entries());
}

std::vector<SentCommand> History::commands_of(const std::vector<v1::Request>& requests) {
    std::vector<SentCommand> commands;
    for (const v1::Request& request : requests) {
        auto command = protocol::to_command(request, {.seed = {7}, .run_id = {++runs_, 1}});
        if (!command) {
            note(shortened(request.ShortDebugString()) + " is invalid: " + to_text(command.error()));
            continue;
        }
        if (auto* set = std::get_if<simulation::SetParameters>(&*command)) {
            set->by = Server::client; // as a server does
        }
        commands.push_back({request, *std::move(command)});
    }
    return commands;
}

void History::send(const std::vector<SentCommand>& commands) {
    server_->send(commands);
    for (const SentCommand& sent : commands) {
        const auto expected = twins_.apply(sent.command);
        expected_[sent.request.request_id()] = text_of(expected);
        note(shortened(sent.request.ShortDebugString()) + "\n   " + text_of(expected));
    }
}

void History::apply(const std::vector<v1::Request>& requests) {
    const std::vector<SentCommand> commands = commands_of(requests);
    send(commands);
    settle();
    compare_answers(commands);
}

void History::compare_answers(const std::vector<SentCommand>& commands) {
    for (const SentCommand& sent : commands) {
        const auto* answer = failure_ ? nullptr : server_->answer_to(sent.request.request_id());
        if (answer != nullptr && text_of(*answer) != expected_[sent.request.request_id()]) {
            fail("the answer: " + text_of(*answer) + ", expected " + expected_[sent.request.request_id()]);
        }
    }
}

void History::settle() {
    if (const auto restless = server_->rest()) {
        return fail(*restless);
    }
    for (const auto& twin : twins_.laboratory().entries()) {
        const Entry* entry = server_->find(twin->name);
        if (entry == nullptr) {
            return fail("the server has no world " + twin->name);
        }
        if (!twins_.advance(twin->name, entry->world.moment().tick)) {
            return fail("the world " + twin->name + " reaches tick " + std::to_string(entry->world.moment().tick) +
                        ", its twin only tick " + std::to_string(twin->world.moment().tick));
        }
    }
}

void History::compare(Depth depth, base::Executor& executor) {
    if (failure_) {
        return;
    }
    const std::size_t count = server_->laboratory().entries().size(), expected = twins_.laboratory().entries().size();
    if (count != expected) {
        return fail("the number of worlds: " + std::to_string(count) + ", expected " + std::to_string(expected));
    }
    for (const auto& twin : twins_.laboratory().entries()) {
        if (const auto difference = difference_of(*server_->find(twin->name), *twin, depth, executor)) {
            return fail("world " + twin->name + ", " + *difference);
        }
    }
}

void History::look_back() {
    const Entry& twin = any_twin();
    const auto& [tick, expected] = draws_.one_of(twins_.memory(twin.name).hashes);
    note("a replay of " + twin.name + " at tick " + std::to_string(tick));
    const auto hash = server_->replayed(twin.name, tick);
    if (!hash) {
        fail("the replay is refused: " + to_text(hash.error()));
    } else if (*hash != expected) {
        fail("the state hash of the replay: " + to_text(*hash) + ", expected " + to_text(expected));
    }
}

void History::stop(base::Executor& executor) {
    const bool while_it_runs = !twins_.laboratory().entries().empty() && actions_left_ > 0 && draws_.chance(0.5);
    if (while_it_runs) {
        send(commands_of(commands_.advance(any_twin())));
        server_->pass(draws_.count(1, 30));
    }
    const bool killed = actions_left_ > 0 && draws_.chance(0.5);
    note(std::string{"the server is "} + (killed ? "killed" : "stopped") + (while_it_runs ? " while it runs" : ""));
    if (killed) {
        kill();
    } else if (!server_->close()) {
        fail("the server has lost data");
    }
    server_.reset();
    if (!failure_ && (actions_left_ == 0 || draws_.chance(0.5))) {
        read_files(executor);
    }
    if (!failure_ && actions_left_ > 0 && !killed && !while_it_runs && draws_.chance(0.5)) {
        fork_file(executor);
    }
}

void History::kill() {
    server_->write_all();
    const std::string before = folder();
    ++folder_;
    fs::copy(before, folder(), fs::copy_options::recursive);
    server_.reset();
    fs::remove_all(before);
}

void History::fork_file(base::Executor& executor) {
    if (twins_.laboratory().entries().empty()) {
        return;
    }
    const Entry& twin = any_twin();
    const auto generation = forkable_generation(twins_.memory(twin.name), draws_);
    const simulation::ForkWorld fork{
        .world = twin.name, .name = commands_.unused_name(), .at_generation = generation, .run_id = {++runs_, 1}};
    note("evod fork " + fork.world + ".evod --name " + fork.name +
         (generation ? " --at-generation " + std::to_string(*generation) : ""));
    const auto path = [this](const std::string& name) { return folder() + "/" + name + ".evod"; };
    auto origin = run_file::RunFile::open_checked(path(fork.world));
    if (!origin) {
        return fail("the file cannot be read: " + to_text(origin.error()));
    }
    const auto moment = replay::fork(**origin, generation, path(fork.name), fork.name, fork.run_id, executor);
    if (!moment) {
        return fail("the file cannot be forked: " + to_text(moment.error()));
    }
    const auto applied = twins_.apply(fork);
    EXPECT_TRUE(applied) << to_text(applied.error());
}

void History::read_files(base::Executor& executor) {
    for (const auto& entry : fs::directory_iterator{folder()}) {
        if (entry.path().extension() == ".evod" && !failure_) {
            verify(entry.path(), executor);
            write_tables(entry.path(), executor);
        }
    }
}

void History::verify(const fs::path& path, base::Executor& executor) {
    const std::string name = path.filename().string();
    auto file = run_file::RunFile::open_checked(path.string());
    if (!file) {
        return fail(name + " cannot be read: " + to_text(file.error()));
    }
    const auto verified = replay::verify(**file, executor, [](const replay::VerifyProgress&) {});
    if (!verified) {
        return fail(name + " cannot be verified: " + to_text(verified.error()));
    }
    if (const auto& found = verified->difference) {
        fail("verify finds a difference in " + name + " in generation " + std::to_string(found->differs.generation) +
             ", tick " + std::to_string(found->differs.tick) + ": " + found->part + ": stored " + found->stored +
             ", simulated again " + found->simulated);
    }
}

void History::write_tables(const fs::path& path, base::Executor& executor) {
    if (failure_) {
        return;
    }
    auto file = run_file::RunFile::open_read_only(path.string());
    ASSERT_TRUE(file);
    ASSERT_TRUE((*file)->pin_snapshot());
    using enum replay::RunTable;
    for (const replay::RunTable table : {Generations, Organisms, Lineage, Population, Events}) {
        std::ostringstream text;
        if (const auto written = replay::write_table({**file, executor}, {.table = table}, text); !written) {
            fail("a table of " + path.filename().string() + " cannot be written: " + to_text(written.error()));
        }
    }
}

void History::note(const std::string& action) {
    actions_ += std::to_string(++lines_) + ". " + action + "\n";
}

void History::fail(const std::string& difference) {
    if (!failure_) {
        failure_ = actions_ + "the first difference: " + difference;
    }
}

} // namespace evod::histories
