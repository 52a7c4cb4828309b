#include "server/runtime/export_job.h"

#include "server/base/within_memory.h"
#include "server/runtime/worker_pool.h"

#include <ostream>
#include <streambuf>
#include <utility>

namespace evod::runtime {

using base::Refusal;
using base::RefusalCode;
using base::Result;

namespace {

Refusal over() {
    return {.code = RefusalCode::FailedPrecondition,
            .message =
                "the export is over, or was cancelled because its next part was not requested in time: begin it again",
            .violations = {},
            .reason = base::Reason::ExportEnded};
}

} // namespace

/// Divides the written text into parts. Writing fails when the client requests no more parts, or the job is cancelled.
class ExportJob::PartBuffer : public std::streambuf {
  public:
    PartBuffer(ExportJob& parts, JobTurns::Turn& turn, const std::stop_token& stop)
        : parts_{parts}, turn_{turn}, stop_{stop} {}

  protected:
    int_type overflow(int_type c) override {
        const char byte = traits_type::to_char_type(c);
        return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
    }
    std::streamsize xsputn(const char* bytes, std::streamsize count) override {
        parts_.text_.append(bytes, static_cast<std::size_t>(count));
        const bool wanted = turn_.go_on() && (parts_.text_.size() < part_bytes ||
                                              parts_.give({.text = std::exchange(parts_.text_, {})}, turn_, stop_));
        return wanted ? count : 0;
    }

  private:
    ExportJob& parts_;
    JobTurns::Turn& turn_;
    const std::stop_token& stop_;
};

ExportJob::ExportJob(const Tools& tools, const std::string& user, replay::StoredRun run,
                     const replay::WantedTable& wanted, std::chrono::milliseconds patience_time)
    : tools_{tools}
    , user_{user}
    , run_{std::move(run)}
    , wanted_{wanted}
    , patience_{patience_time}
    , cancelled_{over()}
    , stop_{tools.jobs.add([this](const std::stop_token& stop) { work(stop); }, user)} {}

ExportJob::~ExportJob() {
    stop_.request_stop();
    std::unique_lock lock{mutex_};
    changed_.wait(lock, [this] { return finished_; });
}

void ExportJob::cancel(const base::Refusal& why) {
    {
        const std::lock_guard lock{mutex_};
        cancelled_ = why;
    }
    stop_.request_stop();
}

bool ExportJob::finished() {
    const std::lock_guard lock{mutex_};
    return finished_;
}

void ExportJob::next(const PartRequest& request) {
    {
        const std::lock_guard lock{mutex_};
        if (!over_) {
            request_ = request;
            changed_.notify_one();
            return;
        }
    }
    tools_.outbox.reply(ExportPartDone{request, over()});
}

bool ExportJob::give(ExportPart part, JobTurns::Turn& turn, const std::stop_token& stop) {
    part.generations_left_out = generations_left_out_;
    PartRequest request;
    turn.give_back();
    {
        std::unique_lock lock{mutex_};
        // A part that was not requested in time is lost. Later parts would leave a gap, so none is returned.
        over_ = over_ || !changed_.wait_for(lock, stop, patience_, [this] { return request_.has_value(); }) ||
                stop.stop_requested();
        if (over_) {
            return false;
        }
        request = *std::exchange(request_, std::nullopt);
        over_ = part.last;
    }
    tools_.outbox.reply(ExportPartDone{request, std::move(part)});
    turn.take();
    return true;
}

Result<void> ExportJob::write(JobTurns::Turn& turn, const std::stop_token& stop) {
    if (!turn.go_on()) {
        return replay::cancelled_refusal();
    }
    const auto file = run_.open();
    if (!file) {
        return file.error();
    }
    if (auto pinned = (*file)->pin_snapshot(); !pinned) {
        return pinned;
    }
    if (wanted_.table == replay::RunTable::Organisms || wanted_.table == replay::RunTable::Lineage) {
        generations_left_out_ = replay::generations_out_of_reach(**file, turn.stop_check());
    }
    const auto executor = make_executor(1);
    PartBuffer buffer{*this, turn, stop};
    std::ostream out{&buffer};
    return replay::write_table({**file, *executor, turn.stop_check()}, wanted_, out);
}

void ExportJob::work(const std::stop_token& stop) {
    {
        JobTurns::Turn turn{tools_.turns, user_, stop};
        const Result<void> written = base::within_memory([&] { return write(turn, stop); });
        if (written) {
            give({.text = std::move(text_), .last = true}, turn, stop);
        }
        turn.give_back();
        end(written, stop);
    }
    const std::lock_guard lock{mutex_};
    finished_ = true;
    // Notify while the lock is held, because the object may be destroyed as soon as the lock is released.
    changed_.notify_all();
}

void ExportJob::end(const Result<void>& written, const std::stop_token& stop) {
    std::optional<PartRequest> request;
    base::Refusal why = over();
    {
        std::unique_lock lock{mutex_};
        if (!written) {
            changed_.wait_for(lock, stop, patience_, [this] { return request_.has_value(); });
            why = written.error();
        }
        if (stop.stop_requested()) {
            why = cancelled_;
        }
        over_ = true;
        request = std::exchange(request_, std::nullopt);
    }
    if (request) {
        tools_.outbox.reply(ExportPartDone{*request, why});
    }
}

} // namespace evod::runtime
