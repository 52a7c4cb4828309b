#include "server/runtime/run_reader.h"

#include <utility>
#include <vector>

namespace evod::runtime {

void RunReader::once_written(const std::string& world, std::function<void(bool)> then) {
    recording::RunRecorder* recorder = recorder_ ? recorder_->of(world) : nullptr;
    if (!recorder || recorder_->refusal()) {
        return then(false); // nothing more will be written, so the caller reads the file in its present state
    }
    const std::uint64_t number = ++last_waiting_;
    waiting_.emplace(number, Waiting{world, std::move(then)});
    const auto done = [this, number](bool all_is_written) {
        mailbox_.push(CallMail{[this, number, all_is_written] {
            if (auto waited = waiting_.extract(number)) {
                waited.mapped().then(all_is_written);
            }
        }});
    };
    recorder->once_written([done] { done(true); }, [done](const base::Refusal&) { done(false); });
}

void RunReader::stop_waiting() {
    for (const auto& [number, waiting] : std::exchange(waiting_, {})) {
        waiting.then(false);
    }
}

void RunReader::stop_waiting(const std::string& world) {
    std::vector<std::function<void(bool)>> stopped;
    std::erase_if(waiting_, [&](auto& item) {
        if (item.second.world != world) {
            return false;
        }
        stopped.push_back(std::move(item.second.then));
        return true;
    });
    for (const auto& then : stopped) {
        then(false);
    }
}

void RunReader::read(std::function<std::function<void()>()> read) {
    jobs_.add([this, read = std::move(read)](const std::stop_token&) { mailbox_.push(CallMail{read()}); });
}

} // namespace evod::runtime
