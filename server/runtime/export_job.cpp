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

/// Divides the written text into parts. Writing fails when the client requests no more parts.
class ExportJob::PartBuffer : public std::streambuf {
  public:
    PartBuffer(ExportJob& parts, const std::stop_token& stop) : parts_{parts}, stop_{stop} {}

  protected:
    int_type overflow(int_type c) override {
        const char byte = traits_type::to_char_type(c);
        return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
    }
    std::streamsize xsputn(const char* bytes, std::streamsize count) override {
        parts_.text_.append(bytes, static_cast<std::size_t>(count));
        const bool wanted =
            parts_.text_.size() < part_bytes || parts_.give({.text = std::exchange(parts_.text_, {})}, stop_);
        return wanted ? count : 0;
    }

  private:
    ExportJob& parts_;
    const std::stop_token& stop_;
};

ExportJob::ExportJob(jobs::JobQueue& jobs, Outbox& outbox, replay::StoredRun run, const replay::WantedTable& wanted,
                     std::chrono::milliseconds patience_time)
    : outbox_{outbox}
    , run_{std::move(run)}
    , wanted_{wanted}
    , patience_{patience_time}
    , stop_{jobs.add([this](const std::stop_token& stop) { work(stop); })} {}

ExportJob::~ExportJob() {
    stop_.request_stop();
    std::unique_lock lock{mutex_};
    changed_.wait(lock, [this] { return finished_; });
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
    outbox_.reply(ExportPartDone{request, over()});
}

bool ExportJob::give(ExportPart part, const std::stop_token& stop) {
    part.generations_left_out = generations_left_out_;
    PartRequest request;
    {
        std::unique_lock lock{mutex_};
        // A part that was not requested in time is lost. Later parts would leave a gap, so none is returned.
        over_ = over_ || !changed_.wait_for(lock, stop, patience_, [this] { return request_.has_value(); });
        if (over_) {
            return false;
        }
        request = *std::exchange(request_, std::nullopt);
        over_ = part.last;
    }
    outbox_.reply(ExportPartDone{request, std::move(part)});
    return true;
}

Result<void> ExportJob::write(const std::stop_token& stop) {
    const auto file = run_.open();
    if (!file) {
        return file.error();
    }
    if (auto pinned = (*file)->pin_snapshot(); !pinned) {
        return pinned;
    }
    if (wanted_.table == replay::RunTable::Organisms || wanted_.table == replay::RunTable::Lineage) {
        generations_left_out_ = replay::generations_out_of_reach(**file);
    }
    const auto executor = make_executor(1);
    PartBuffer buffer{*this, stop};
    std::ostream out{&buffer};
    return replay::write_table({**file, *executor, stop}, wanted_, out);
}

void ExportJob::work(const std::stop_token& stop) {
    const Result<void> written = base::within_memory([&] { return write(stop); });
    if (written) {
        give({.text = std::move(text_), .last = true}, stop);
    }
    std::optional<PartRequest> request;
    {
        std::unique_lock lock{mutex_};
        if (!written) {
            changed_.wait_for(lock, stop, patience_, [this] { return request_.has_value(); });
        }
        over_ = true;
        request = std::exchange(request_, std::nullopt);
    }
    if (request) {
        outbox_.reply(ExportPartDone{*request, written ? over() : written.error()});
    }
    const std::lock_guard lock{mutex_};
    finished_ = true;
    // Notify while the lock is held, because the object may be destroyed as soon as the lock is released.
    changed_.notify_all();
}

} // namespace evod::runtime
