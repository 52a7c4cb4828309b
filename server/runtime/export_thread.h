// Export thread: writes a table of a run for somebody who takes it in parts, as they ask for them.
//
// Threads   one of its own for each export. It reads the run's file beside whoever writes to it, and alone simulates
//           again what the file does not hold any more; no world waits for it.
// Full      while a part is made that nobody has asked for, it waits. It holds the file still meanwhile, so it gives up
//           after `patience`.
#pragma once

#include "server/replay/past.h"
#include "server/replay/run_tables.h"

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace evod::runtime {

class ExportThread {
  public:
    static constexpr std::size_t part_bytes = 256 << 10; // at least, of all parts but the last
    static constexpr std::chrono::milliseconds patience = std::chrono::seconds{30};

    struct Part {
        std::string text;
        bool last = false;                      // the table ends with it
        std::uint64_t generations_left_out = 0; // replay::generations_out_of_reach(), of organisms or their lineage
    };
    /// Called on the export's thread; must not block.
    using Reply = std::function<void(base::Result<Part>)>;

    ExportThread(replay::Past run, const replay::WantedTable& wanted,
                 std::chrono::milliseconds asked_within = patience);
    /// Stops the work under way, and waits for that.
    ~ExportThread();

    /// Asks for the next part; not before the one before was answered. After the last part, or a refusal, there is
    /// none: refused.
    void next(Reply reply);

    /// Its thread has nothing to do any more.
    void request_stop();
    bool finished() const { return finished_.load(std::memory_order_acquire); }

  private:
    class PartBuffer;

    void work(const std::stop_token& stop);
    base::Result<void> write(const std::stop_token& stop);
    /// Gives a part to whoever has asked or asks within the patience; false if nobody does.
    bool give(Part part, const std::stop_token& stop);

    const replay::Past run_;
    const replay::WantedTable wanted_;
    const std::chrono::milliseconds patience_;
    std::uint64_t generations_left_out_ = 0;
    std::string text_; // of the part that is being made
    std::atomic<bool> finished_ = false;

    std::mutex mutex_; // guards what follows
    std::condition_variable_any asked_;
    Reply reply_;       // of the part that has been asked for and not given
    bool over_ = false; // nothing more is given
    std::jthread thread_;
};

} // namespace evod::runtime
