// Two loops: the loops of the live worlds and of the replays of a server, on the thread of the test, with what the
// network thread does between them.
#pragma once

#include "server/runtime/fork.h"
#include "server/runtime/simulations.h"
#include "server/simulation/world_name.h"

#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace evod::support {

class TwoLoops {
  public:
    /// on_answer  receives what the network thread would answer, in pass().
    /// outputs    those of both loops, apart from `reply`.
    TwoLoops(base::Executor& executor, runtime::Clock& clock, std::function<void(runtime::Answer)> on_answer,
             runtime::LoopOutputs outputs, simulation::Laboratory laboratory = {},
             recording::Recorder* recorder = nullptr)
        : on_answer_{std::move(on_answer)}
        , live{{live_.mailbox, live_.demand, executor, clock}, with_reply(outputs), std::move(laboratory), recorder}
        , replays{{replays_.mailbox, replays_.demand, executor, clock},
                  of_replays(with_reply(outputs)),
                  simulations.job_turns()} {}

    runtime::Simulations simulations{false};
    /// Sees every reply, on the thread that gives it. Returns whether it has handled the reply.
    std::function<bool(const runtime::Reply&)> handles = [](const runtime::Reply&) { return false; };

    /// Lets both loops pass once, and handles their replies. Returns when the next pass is due if no mail arrives.
    std::optional<runtime::Clock::time_point> pass() {
        handle_replies();
        const auto first = live.pass(), second = replays.pass();
        handle_replies();
        return first && second ? std::min(*first, *second) : first ? first : second;
    }
    /// Hands the replies of both loops on.
    void handle_replies() {
        std::unique_lock lock{mutex_};
        std::vector<runtime::Reply> posted = std::exchange(posted_, {});
        lock.unlock();
        for (runtime::Reply& reply : posted) {
            auto answer = simulations.pass_on(std::move(reply));
            if (auto* done = answer ? std::get_if<runtime::CommandDone>(&*answer) : nullptr; done && done->fork) {
                const std::stop_token never;
                runtime::JobTurns::Turn turn{simulations.job_turns(), {}, never};
                answer = check_fork(std::move(*done), turn);
            }
            if (answer) {
                on_answer_(*std::move(answer));
            }
        }
    }
    /// The world or replay of this name; nullptr if there is none.
    const simulation::Entry* find(std::string_view name) const {
        const auto entry = (simulation::is_replay_name(name) ? replays.laboratory() : live.laboratory()).find(name);
        return entry ? *entry : nullptr;
    }

  private:
    runtime::LoopOutputs with_reply(runtime::LoopOutputs outputs) {
        outputs.reply = [this](runtime::Reply reply) {
            if (handles(reply)) {
                return;
            }
            {
                const std::lock_guard lock{mutex_};
                posted_.push_back(std::move(reply));
            }
            live_.mailbox.wake();
        };
        return outputs;
    }
    static runtime::LoopOutputs of_replays(runtime::LoopOutputs outputs) {
        outputs.counted = nullptr;
        return outputs;
    }

    runtime::Simulations::Part& live_ = simulations.part_of("");
    runtime::Simulations::Part& replays_ = simulations.part_of("replay@1");
    std::function<void(runtime::Answer)> on_answer_;
    std::mutex mutex_; // guards the next member
    std::vector<runtime::Reply> posted_;

  public:
    runtime::SimulationLoop live;
    runtime::ReplayLoop replays;
};

} // namespace evod::support
