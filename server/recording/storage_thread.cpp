#include "server/recording/storage_thread.h"

#include "server/base/overloaded.h"
#include "server/log/log.h"
#include "server/run_file/checkpoint.h"
#include "server/run_file/data_folder.h"

#include <pthread.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace evod::recording {
namespace {

using base::Refusal;
using base::Result;

std::size_t bytes_of(const StorageThread::Record& record) {
    constexpr std::size_t small = 256;
    return std::visit(base::Overloaded{
                          [](const run_file::JournalEntry& entry) {
                              return small + entry.origin.request.size() + entry.answer.size();
                          },
                          [](const run_file::Inherited& inherited) {
                              std::size_t bytes = small;
                              for (const simulation::GenerationRows& rows : inherited.history) {
                                  bytes += rows.size() * sizeof(simulation::GenerationStatistics);
                              }
                              return bytes;
                          },
                          [](const run_file::GenerationBegun& begun) {
                              std::size_t bytes = small;
                              for (const std::vector<std::uint32_t>& founders : begun.founders) {
                                  bytes += founders.size() * sizeof(std::uint32_t);
                              }
                              for (const evolution::NextGeneration& born : begun.born) {
                                  bytes += static_cast<std::size_t>(born.genes.cols()) *
                                           (sizeof(float) * evolution::gene_count + sizeof(evolution::Parents));
                              }
                              return bytes;
                          },
                          [](const run_file::GenerationEnded& ended) {
                              std::size_t bytes = small;
                              bytes += ended.statistics.size() * sizeof(simulation::GenerationStatistics);
                              for (const run_file::IslandOutcome& outcome : ended.outcomes) {
                                  bytes +=
                                      small + outcome.fitness.size() * (sizeof(double) + sizeof(std::uint32_t) + 1);
                              }
                              return bytes;
                          },
                          // These have a bound of their own.
                          [](const run_file::Checkpoint&) { return std::size_t{0}; },
                          [](const run_file::StoredCheckpoint&) { return std::size_t{0}; },
                          [](const auto&) { return sizeof(run_file::HashLink); },
                      },
                      record);
}

/// there  something else has it.
Refusal lost_its_name(const std::string& path, bool there) {
    return {.code = base::RefusalCode::NotFound,
            .message =
                path + (there ? " is another file than the one that is written" : " has been moved or deleted") +
                ": move it back; if it cannot be, what comes now ends with the server, and a copy has to be put there "
                "before the next one starts",
            .violations = {}};
}

Refusal is_there(const std::string& path) {
    return {.code = base::RefusalCode::AlreadyExists,
            .message = path + " is there already, and holds another run: move it away, and what waits is written",
            .violations = {}};
}

} // namespace

StorageThread::StorageThread(run_file::RunFile::Options options, std::chrono::milliseconds retry_after)
    : options_{options}, retry_after_{retry_after}, thread_{[this] { work(); }} {}

StorageThread::~StorageThread() {
    finish();
}

bool StorageThread::finish() {
    if (thread_.joinable()) {
        {
            const std::lock_guard lock{mutex_};
            stopping_ = true;
        }
        changed_.notify_one();
        thread_.join();
    }
    return !lost_;
}

std::vector<StorageThread::Item> StorageThread::items_of(Batch batch) {
    std::vector<Item> items;
    std::size_t bytes = 0;
    for (Record& record : batch.records) {
        const std::size_t record_bytes = bytes_of(record);
        items.push_back({.record = std::move(record), .done = {}, .writing = {}, .bytes = record_bytes});
        bytes += record_bytes;
    }
    if (items.empty()) {
        items.emplace_back();
    }
    if (batch.done) {
        items.back().handed_over = std::chrono::steady_clock::now();
    }
    items.back().done = std::move(batch.done);
    waiting_bytes_.fetch_add(bytes, std::memory_order_relaxed);
    return items;
}

StorageThread::RunNumber StorageThread::add(Run run, std::vector<Item> items,
                                            std::optional<std::pair<RunNumber, Closing>> old) {
    RunNumber number = 0;
    {
        const std::lock_guard lock{mutex_};
        number = run.number = ++last_number_;
        new_runs_.emplace(number, std::move(run));
        if (old) {
            closing_.insert(*std::move(old));
        }
        if (!items.empty()) {
            wait_in_line(number, std::move(items));
        }
    }
    changed_.notify_one();
    return number;
}

StorageThread::RunNumber StorageThread::create(const std::string& path, run_file::RunIdentity identity, Batch first) {
    Run run;
    run.path = path;
    run.to_create = std::move(identity);
    run.unnamed = true;
    return add(std::move(run), items_of(std::move(first)));
}

StorageThread::RunNumber StorageThread::replace(RunNumber old_run, Ending ending, const std::string& path,
                                                run_file::RunIdentity identity, Batch first) {
    Run run;
    run.path = path;
    run.to_create = std::move(identity);
    run.unnamed = true;
    run.replaces = old_run;
    Closing closing{.last = items_of(std::move(ending.last)), .renamed = std::move(ending.renamed), .replaced = true};
    return add(std::move(run), items_of(std::move(first)), std::pair{old_run, std::move(closing)});
}

StorageThread::RunNumber StorageThread::adopt(std::unique_ptr<run_file::RunFile> file) {
    Run run;
    run.path = file->path();
    run.file = std::move(file);
    (void)mind_name(run, {}); // what has it now is the file
    return add(std::move(run), {});
}

void StorageThread::write(RunNumber run, Batch batch) {
    hand_over(run, items_of(std::move(batch)));
}

void StorageThread::write(RunNumber run, run_file::Checkpoint checkpoint, std::shared_ptr<CheckpointWriting> writing) {
    writing->waits = true;
    waiting_checkpoints_.fetch_add(1);
    std::vector<Item> items;
    items.push_back({.record = std::move(checkpoint), .done = {}, .writing = std::move(writing)});
    hand_over(run, std::move(items));
}

void StorageThread::close(RunNumber run, Ending ending) {
    Closing closing{.last = items_of(std::move(ending.last)), .renamed = std::move(ending.renamed)};
    {
        const std::lock_guard lock{mutex_};
        closing_.emplace(run, std::move(closing));
        urgent_ = true;
    }
    changed_.notify_one();
}

void StorageThread::hand_over(RunNumber run, std::vector<Item> items) {
    bool wake = false;
    {
        const std::lock_guard lock{mutex_};
        wake = wait_in_line(run, std::move(items));
    }
    if (wake) {
        changed_.notify_one();
    }
}

bool StorageThread::wait_in_line(RunNumber run, std::vector<Item> items) {
    std::size_t bytes = 0;
    for (const Item& item : items) {
        bytes += item.bytes;
    }
    urgent_ |= items.back().done != nullptr || bytes > gathered_bytes_max;
    // Somebody who waits, and the first of what is gathered.
    const bool wake = urgent_ || handed_over_.empty();
    if (handed_over_.empty()) {
        handed_over_since_ = std::chrono::steady_clock::now();
    }
    std::vector<Item>& waiting = handed_over_[run];
    waiting.insert(waiting.end(), std::make_move_iterator(items.begin()), std::make_move_iterator(items.end()));
    return wake;
}

std::optional<std::chrono::steady_clock::time_point> StorageThread::waiting_since() const {
    const std::lock_guard lock{mutex_};
    return taken_since_ ? taken_since_ : handed_over_since_;
}

std::optional<std::string> StorageThread::trouble() const {
    const std::lock_guard lock{mutex_};
    return trouble_.empty() ? std::nullopt : std::optional{trouble_};
}

void StorageThread::when_changed(std::function<void()> changed) {
    const std::lock_guard lock{mutex_};
    when_changed_ = std::move(changed);
}

void StorageThread::set_trouble(const std::string& why) {
    std::string before;
    {
        const std::lock_guard lock{mutex_};
        before = std::exchange(trouble_, why);
        if (before != why && when_changed_) {
            when_changed_();
        }
    }
    if (before.empty() && !why.empty()) {
        log::error("{}; commands are refused until it can be written again", why);
    } else if (!before.empty() && why.empty()) {
        log::info("run files can be written again");
    }
}

void StorageThread::work() {
    pthread_setname_np(pthread_self(), "storage"); // as `top -H` shows it
    constexpr int put_off_max = 8;                 // however many commands there are
    int put_off = 0;
    for (bool more = false;;) {
        const bool stopping = take(more);
        const bool hurries = !std::exchange(failed_, false);
        for (auto& [number, run] : runs_) {
            pack_next(run);
        }
        more = write_out();
        if (hurries && put_off < put_off_max && somebody_waits()) {
            ++put_off;
            more = true;
        } else {
            put_off = 0;
            more |= do_a_little();
        }
        std::erase_if(runs_, [](const auto& item) { return item.second.closing && item.second.closing->finished; });
        if (!failed_) {
            const bool all_written =
                std::ranges::all_of(runs_, [](const auto& run) { return run.second.waiting.empty(); });
            if (all_written) {
                const std::lock_guard lock{mutex_};
                taken_since_.reset();
            }
            set_trouble({});
        }
        // What fails is given up only when nothing else can be written any more.
        const bool advanced = std::exchange(advanced_, false);
        if (stopping && !more && !is_awaiting() && !(failed_ && advanced)) {
            if (failed_) {
                say_what_is_lost();
            }
            return;
        }
    }
}

bool StorageThread::take(bool more) {
    std::vector<Packed> packed;
    std::vector<RunNumber> copied;
    bool stopping = false;
    {
        std::unique_lock lock{mutex_};
        const auto hurries = [this] {
            return urgent_ || !packed_.empty() || !copied_.empty() || (stopping_ && away_ == 0);
        };
        if (failed_) {
            changed_.wait_for(lock, retry_after_,
                              [this] { return stopping_ && (away_ == 0 || !packed_.empty() || !copied_.empty()); });
        } else if (!more) {
            working_ = false;
            changed_.wait(lock, [&] { return hurries() || !handed_over_.empty(); });
            working_ = true;
            changed_.wait_for(lock, gathering_time, [&] { return hurries() || stopping_; });
        }
        stopping = stopping_;
        packed = std::exchange(packed_, {});
        copied = std::exchange(copied_, {});
        const auto now = std::chrono::steady_clock::now();
        if (!more || failed_ || urgent_ || stopping ||
            (handed_over_since_ && now - *handed_over_since_ >= gathering_time)) {
            urgent_ = false;
            if (!taken_since_) {
                taken_since_ = handed_over_since_;
            }
            handed_over_since_.reset();
            runs_.merge(new_runs_);
            new_runs_.clear();
            for (auto& [number, items] : std::exchange(handed_over_, {})) {
                Run& run = runs_[number];
                for (Item& item : items) {
                    (item.writing ? run.checkpoints : run.waiting).push_back(std::move(item));
                }
            }
            for (auto& [number, closing] : std::exchange(closing_, {})) {
                runs_[number].closing = std::move(closing);
            }
        }
    }
    for (Packed& one : packed) {
        take_back(std::move(one));
    }
    for (const RunNumber run : copied) {
        take_back_log(run);
    }
    return stopping;
}

bool StorageThread::is_awaiting() {
    const std::lock_guard lock{mutex_};
    return away_ > 0 || !handed_over_.empty() || !closing_.empty();
}

bool StorageThread::somebody_waits() {
    const std::lock_guard lock{mutex_};
    return urgent_;
}

void StorageThread::pack_next(Run& run) {
    if (run.packing) {
        return;
    }
    for (std::vector<Item>* items : {&run.waiting, &run.checkpoints}) {
        for (Item& item : *items) {
            run_file::Checkpoint* checkpoint = item.record ? std::get_if<run_file::Checkpoint>(&*item.record) : nullptr;
            if (checkpoint == nullptr) {
                continue;
            }
            item.away = run.packing = true;
            ++away_;
            packing_.add(
                [this, number = run.number, given = std::make_shared<run_file::Checkpoint>(std::move(*checkpoint))] {
                    const auto began = std::chrono::steady_clock::now();
                    Packed packed{.run = number, .checkpoint = run_file::pack(*given), .took = {}};
                    packed.took = std::chrono::steady_clock::now() - began;
                    *given = {};
                    {
                        const std::lock_guard lock{mutex_};
                        packed_.push_back(std::move(packed));
                    }
                    changed_.notify_one();
                });
            return;
        }
    }
}

void StorageThread::take_back(Packed packed) {
    --away_;
    const auto run = runs_.find(packed.run);
    if (run == runs_.end()) {
        return;
    }
    run->second.packing = false;
    for (std::vector<Item>* items : {&run->second.waiting, &run->second.checkpoints}) {
        for (Item& item : *items) {
            if (std::exchange(item.away, false)) {
                item.record = std::move(packed.checkpoint);
                item.took = packed.took;
                return;
            }
        }
    }
}

void StorageThread::copy_log_if_long(Run& run) {
    if (!run.file || run.unnamed || run.copying) {
        return;
    }
    const std::uint32_t pages = run.file->log_pages();
    if (pages < run.pages_asked) { // it has begun anew
        run.pages_asked = 0;
    }
    if (pages < run.pages_asked + options_.log_pages_max) {
        return;
    }
    run.pages_asked = pages;
    run.copying = true;
    ++away_;
    packing_.add([this, number = run.number, path = run.path] {
        run_file::RunFile::copy_log(path, options_);
        {
            const std::lock_guard lock{mutex_};
            copied_.push_back(number);
        }
        changed_.notify_one();
    });
}

void StorageThread::take_back_log(RunNumber number) {
    --away_;
    const auto found = runs_.find(number);
    if (found == runs_.end()) {
        return;
    }
    Run& run = found->second;
    run.copying = false;
    constexpr std::uint32_t too_long = 4; // times as long as it is to be
    if (!run.file || run.file->log_pages() == run.pages_asked ||
        run.file->log_pages() < too_long * options_.log_pages_max) {
        return;
    }
    run.file->copy_log();
    run.pages_asked = run.file->log_pages();
}

void StorageThread::wait_for_copy(Run& run) {
    if (!run.copying) {
        return;
    }
    {
        std::unique_lock lock{mutex_};
        changed_.wait(lock, [&] { return std::ranges::find(copied_, run.number) != copied_.end(); });
        std::erase(copied_, run.number);
    }
    --away_;
    run.copying = false;
}

void StorageThread::say_what_is_lost() {
    for (const auto& [number, run] : runs_) {
        std::size_t bytes = 0, commands = 0, generations = 0;
        const auto count = [&](const std::vector<Item>& items) {
            for (const Item& item : items) {
                bytes += item.bytes;
                commands += item.record && std::holds_alternative<run_file::JournalEntry>(*item.record);
                generations += item.record && std::holds_alternative<run_file::GenerationEnded>(*item.record);
            }
        };
        count(run.waiting);
        if (run.closing && !run.closing->marked) {
            count(run.closing->last);
        }
        if (bytes == 0) {
            continue;
        }
        lost_ = true;
        const std::string world = std::filesystem::path{run.path}.stem().string();
        const std::string lacking =
            fmt::format("{} bytes could not be written: the ends of {} generations, {} commands, and "
                        "where it stood last",
                        bytes, generations, commands);
        if (run.known_as && run.known_as->lost) {
            log::error({.world = world},
                       "world \"{}\": {}. Its file, {}, has been moved or deleted: put it back, or a copy", world,
                       lacking, run.path);
        } else if (run.unnamed) {
            log::error({.world = world}, "world \"{}\": {}. {} was not made, and nobody was told that it was", world,
                       lacking, run.path);
        } else {
            log::error({.world = world},
                       "world \"{}\": {}. {} has all that was answered, and the world goes on from there once there is "
                       "room",
                       world, lacking, run.path);
        }
    }
}

bool StorageThread::fail(Run& run, const Refusal& why) {
    run.file.reset();
    return fail(why);
}

bool StorageThread::fail(const Refusal& why) {
    if (!std::exchange(failed_, true)) {
        set_trouble(why.message); // that of the first, as long as it fails, however many do
    }
    return false;
}

Result<void> StorageThread::begin(Run& run) {
    if (!run.file) {
        const auto is_new = open(run);
        if (!is_new) {
            return is_new.error();
        }
        if (*is_new) { // and has begun
            return {};
        }
    }
    run.file->begin();
    return {};
}

Result<bool> StorageThread::open(Run& run) {
    const std::string path = run.unnamed ? run_file::DataFolder::next_file_of(run.path) : run.path;
    // One that was to be created may be there already, if it is not known how creating it went.
    Result<std::unique_ptr<run_file::RunFile>> file = run_file::RunFile::open(path, options_);
    const bool is_new = run.to_create && !file;
    if (is_new) { // with all that it begins with, so that nobody finds one that has less
        file = run_file::RunFile::begin_new(path, *run.to_create, options_);
    } else if (run.to_create && (*file)->identity().run_id != run.to_create->run_id) {
        file = is_there(path);
    }
    std::error_code error;
    if (!file && !run.to_create && !std::filesystem::exists(path, error)) {
        return lost_its_name(path, false);
    }
    if (!file) {
        return file.error();
    }
    run.file = *std::move(file);
    run.known_as.reset();
    (void)mind_name(run, std::chrono::steady_clock::now()); // so that it is known as what was opened
    run.pages_asked = 0;
    return is_new;
}

std::optional<Refusal> StorageThread::mind_name(Run& run, std::chrono::steady_clock::time_point now) {
    if (!run.file || run.unnamed) {
        run.known_as.reset();
        return std::nullopt;
    }
    if (run.known_as && !run.known_as->lost && now - run.known_as->looked < look_time) {
        return std::nullopt;
    }
    struct stat about {};
    const bool there = ::stat(run.path.c_str(), &about) == 0;
    if (!run.known_as) { // it has just been opened
        if (!there) {
            return lost_its_name(run.path, false);
        }
        run.known_as = Name{.device = about.st_dev, .number = about.st_ino};
    }
    run.known_as->looked = now;
    run.known_as->lost = !there || about.st_dev != run.known_as->device || about.st_ino != run.known_as->number;
    if (!run.known_as->lost) {
        return std::nullopt;
    }
    return lost_its_name(run.path, there);
}

bool StorageThread::commit(Run& run, const std::vector<Item>& items) {
    if (std::ranges::none_of(items, [](const Item& item) { return item.record.has_value(); })) {
        return true;
    }
    if (auto gone = mind_name(run, std::chrono::steady_clock::now())) {
        return fail(*gone);
    }
    if (auto begun = begin(run); !begun) {
        return fail(run, begun.error());
    }
    for (const Item& item : items) {
        if (item.record) {
            std::visit([&](const auto& record) { run.file->write(record); }, *item.record);
        }
    }
    const auto began = std::chrono::steady_clock::now();
    if (auto committed = run.file->commit(); !committed) {
        return fail(run, committed.error());
    }
    times_.commit.add(std::chrono::steady_clock::now() - began);
    if (run.to_create) {
        if (auto settled = run.file->settle(); !settled) {
            return fail(run, settled.error());
        }
    }
    run.to_create.reset();
    copy_log_if_long(run);
    advanced_ = true;
    return true;
}

void StorageThread::tell(std::vector<Item>& items) {
    std::size_t bytes = 0;
    for (const Item& item : std::exchange(items, {})) {
        bytes += item.bytes;
        if (item.done) {
            if (item.record) { // with a command as its last
                times_.journal_wait.add(std::chrono::steady_clock::now() - item.handed_over);
            }
            item.done();
        }
        if (item.writing) {
            item.writing->took = item.took;
            item.writing->waits = false;
            waiting_checkpoints_.fetch_sub(1);
        }
    }
    const std::size_t before = waiting_bytes_.fetch_sub(bytes, std::memory_order_release);
    if (before < waiting_bytes_max || before - bytes >= waiting_bytes_max) {
        return;
    }
    const std::lock_guard lock{mutex_};
    if (when_changed_) {
        when_changed_();
    }
}

bool StorageThread::write_out() {
    std::vector<Run*> others;
    for (auto& [number, run] : runs_) {
        if (run.closing || std::ranges::any_of(run.waiting, [](const Item& item) { return item.done != nullptr; })) {
            (void)write_out(run);
        } else if (!run.waiting.empty() || run.unnamed) {
            others.push_back(&run);
        }
    }
    // Each in its turn, however many commands there are.
    std::stable_partition(others.begin(), others.end(), [this](const Run* run) { return run->number > last_written_; });
    for (Run* run : others) {
        if (run != others.front() && somebody_waits()) {
            return true;
        }
        last_written_ = run->number;
        (void)write_out(*run);
    }
    return false;
}

bool StorageThread::write_out(Run& run) {
    const auto is_unpacked = [](const Item& item) {
        return item.record && std::holds_alternative<run_file::Checkpoint>(*item.record);
    };
    if (std::ranges::any_of(run.waiting, is_unpacked) || !is_its_turn(run)) {
        return false; // not yet
    }
    const bool news = !run.waiting.empty();
    if (news) {
        if (!commit(run, run.waiting)) {
            return false;
        }
        run.written.insert(run.written.end(), std::make_move_iterator(run.waiting.begin()),
                           std::make_move_iterator(run.waiting.end()));
        run.waiting.clear();
    }
    if (run.unnamed && !run.to_create && !take_place(run)) {
        return false;
    }
    tell(run.written);
    if (run.closing) {
        return run.closing->replaced || end(run);
    }
    // What is written stays written if this fails.
    if (news && run.file) {
        if (const auto thinned = run.file->thin_if_large(); !thinned) {
            return fail(run, thinned.error());
        }
    }
    if (run.file && !run.said_large && run.file->is_large()) {
        log::warn("{} is larger than it should be: what is kept for good takes more", run.path);
        run.said_large = true;
    }
    return true;
}

bool StorageThread::is_its_turn(const Run& run) {
    for (auto& item : runs_) {
        Run& earlier = item.second;
        if (item.first >= run.number) {
            break;
        }
        if (earlier.path != run.path) {
            continue;
        }
        const bool is_replaced = run.replaces == item.first;
        const auto is_out_of_the_way = [&] {
            return is_replaced ? !earlier.unnamed : earlier.closing && earlier.closing->finished;
        };
        if (!is_out_of_the_way()) {
            (void)write_out(earlier);
            if (!is_out_of_the_way()) {
                return false;
            }
        }
    }
    return true;
}

bool StorageThread::do_a_little() {
    std::vector<Run*> runs;
    for (auto& [number, run] : runs_) {
        runs.push_back(&run);
    }
    std::stable_partition(runs.begin(), runs.end(), [this](const Run* run) { return run->number > last_little_; });
    return std::ranges::any_of(runs, [this](Run* run) {
        last_little_ = run->number;
        return do_a_little(*run);
    });
}

bool StorageThread::do_a_little(Run& run) {
    const bool finished = run.closing && run.closing->finished;
    if (run.unnamed || run.copying || finished || !run.waiting.empty()) {
        return false;
    }
    if (run.file) {
        const auto tidied = run.file->tidy();
        if (!tidied) {
            return fail(run, tidied.error());
        }
        if (*tidied) {
            copy_log_if_long(run);
            return true;
        }
    }
    const bool there_is_one = !run.checkpoints.empty() && run.checkpoints.front().record &&
                              std::holds_alternative<run_file::StoredCheckpoint>(*run.checkpoints.front().record);
    if (!there_is_one) {
        return false;
    }
    if (!run.file) {
        if (const auto opened = open(run); !opened) {
            return fail(run, opened.error());
        }
    }
    Item& item = run.checkpoints.front();
    const auto began = std::chrono::steady_clock::now();
    const auto whole = run.file->write_part(std::get<run_file::StoredCheckpoint>(*item.record));
    if (!whole) {
        return fail(run, whole.error());
    }
    item.took += std::chrono::steady_clock::now() - began;
    if (*whole) {
        std::vector<Item> written;
        written.push_back(std::move(item));
        run.checkpoints.erase(run.checkpoints.begin());
        tell(written);
    }
    copy_log_if_long(run);
    return true;
}

void StorageThread::leave_out_checkpoints(Run& run) {
    for (const Item& item : std::exchange(run.checkpoints, {})) {
        item.writing->waits = false;
        waiting_checkpoints_.fetch_sub(1);
    }
}

bool StorageThread::take_place(Run& run) {
    if (const auto old = run.replaces ? runs_.find(*run.replaces) : runs_.end(); old != runs_.end()) {
        old->second.closing->replaced = false;
        if (!write_out(old->second) || !old->second.closing->finished) {
            return false;
        }
    }
    run.file.reset();
    std::error_code error;
    if (std::filesystem::exists(run.path, error)) {
        return fail(run, is_there(run.path));
    }
    if (const auto moved = run_file::RunFile::rename(run_file::DataFolder::next_file_of(run.path), run.path); !moved) {
        return fail(run, moved.error());
    }
    run.replaces.reset();
    run.unnamed = false;
    advanced_ = true;
    return true;
}

bool StorageThread::end(Run& run) {
    Closing& closing = *run.closing;
    if (closing.finished) {
        return true;
    }
    const auto& last = closing.last.back().record;
    if (last && std::holds_alternative<run_file::EndMark>(*last) && std::get<run_file::EndMark>(*last).ended) {
        leave_out_checkpoints(run);
    }
    if (!run.checkpoints.empty()) {
        return false; // again, once they are written
    }
    wait_for_copy(run);
    if (!closing.marked) {
        if (!commit(run, closing.last)) {
            return false;
        }
        closing.marked = true;
        run.file.reset();
    }
    if (!closing.renamed.empty()) {
        if (const auto moved = run_file::RunFile::rename(run.path, closing.renamed); !moved) {
            return fail(run, moved.error());
        }
    }
    closing.finished = true;
    advanced_ = true;
    tell(closing.last);
    return true;
}

} // namespace evod::recording
