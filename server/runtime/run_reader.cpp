#include "server/runtime/run_reader.h"

#include <utility>

namespace evod::runtime {

void RunReader::once_written(const std::string& world, std::function<void(bool)> then) {
    recording::RunRecorder* recorder = recorder_ ? recorder_->of(world) : nullptr;
    if (!recorder || recorder_->refusal()) {
        return then(false); // nothing more will be written, so the caller reads the file in its present state
    }
    const std::uint64_t number = ++last_waiting_;
    waiting_.emplace(number, std::move(then));
    recorder->once_written([this, number] {
        mailbox_.push(CallMail{[this, number] {
            if (auto waited = waiting_.extract(number)) {
                waited.mapped()(true);
            }
        }});
    });
}

void RunReader::stop_waiting() {
    for (const auto& [number, then] : std::exchange(waiting_, {})) {
        then(false);
    }
}

void RunReader::read(std::function<std::function<void()>()> read) {
    jobs_.add([this, read = std::move(read)](const std::stop_token&) { mailbox_.push(CallMail{read()}); });
}

} // namespace evod::runtime
