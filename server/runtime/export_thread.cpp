#include "server/runtime/export_thread.h"

#include "server/base/within_memory.h"
#include "server/runtime/worker_pool.h"

#include <pthread.h>

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
            .message = "the export is over, or was given up because nobody went on with it: begin it again",
            .violations = {},
            .reason = base::Reason::ExportEnded};
}

} // namespace

/// Cuts what is written into parts; a stream on it goes bad when nobody wants more.
class ExportThread::PartBuffer : public std::streambuf {
  public:
    PartBuffer(ExportThread& parts, const std::stop_token& stop) : parts_{parts}, stop_{stop} {}

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
    ExportThread& parts_;
    const std::stop_token& stop_;
};

ExportThread::ExportThread(replay::Past run, const replay::WantedTable& wanted, std::chrono::milliseconds asked_within)
    : run_{std::move(run)}
    , wanted_{wanted}
    , patience_{asked_within}
    , thread_{[this](const std::stop_token& stop) { work(stop); }} {}

ExportThread::~ExportThread() = default;

void ExportThread::request_stop() {
    thread_.request_stop();
}

void ExportThread::next(Reply reply) {
    {
        const std::lock_guard lock{mutex_};
        if (!over_) {
            reply_ = std::move(reply);
            asked_.notify_one();
            return;
        }
    }
    reply(over());
}

bool ExportThread::give(Part part, const std::stop_token& stop) {
    part.generations_left_out = generations_left_out_;
    Reply reply;
    {
        std::unique_lock lock{mutex_};
        // What nobody asked for in time is not given later either: something would be missing.
        over_ = over_ || !asked_.wait_for(lock, stop, patience_, [this] { return reply_ != nullptr; });
        if (over_) {
            return false;
        }
        reply = std::exchange(reply_, {});
        over_ = part.last;
    }
    reply(std::move(part));
    return true;
}

Result<void> ExportThread::write(const std::stop_token& stop) {
    const auto file = run_.open();
    if (!file) {
        return file.error();
    }
    if (auto held = (*file)->hold_still(); !held) {
        return held;
    }
    if (wanted_.table == replay::RunTable::Organisms || wanted_.table == replay::RunTable::Lineage) {
        generations_left_out_ = replay::generations_out_of_reach(**file);
    }
    const auto executor = make_executor(1);
    PartBuffer buffer{*this, stop};
    std::ostream out{&buffer};
    return replay::write_table({**file, *executor, stop}, wanted_, out);
}

void ExportThread::work(const std::stop_token& stop) {
    pthread_setname_np(pthread_self(), "export"); // as `top -H` shows it
    const Result<void> written = base::within_memory([&] { return write(stop); });
    if (written) {
        give({.text = std::move(text_), .last = true}, stop);
    }
    Reply reply;
    {
        std::unique_lock lock{mutex_};
        if (!written) {
            asked_.wait_for(lock, stop, patience_, [this] { return reply_ != nullptr; });
        }
        over_ = true;
        reply = std::exchange(reply_, {});
    }
    if (reply) {
        reply(written ? over() : written.error());
    }
    finished_.store(true, std::memory_order_release);
}

} // namespace evod::runtime
