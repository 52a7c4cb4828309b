#include "server/runtime/run_reader.h"

#include <utility>

namespace evod::runtime {

void RunReader::once_written(const std::string& world, std::function<void(bool)> then) {
    recording::RunRecorder* recorder = recorder_ ? recorder_->of(world) : nullptr;
    if (!recorder) {
        return then(false);
    }
    const recording::Ticket ticket = next_ticket_++;
    waiting_.emplace(ticket, std::move(then));
    recorder->once_written(ticket);
}

void RunReader::take(const recording::Receipt& receipt) {
    const auto then = std::move(waiting_.extract(receipt.ticket).mapped());
    then(!receipt.refused);
}

void RunReader::read(std::function<std::function<void()>()> read) {
    jobs_.add([this, read = std::move(read)](const std::stop_token&) { mailbox_.push(CallMail{read()}); });
}

} // namespace evod::runtime
