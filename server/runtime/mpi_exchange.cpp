// The component evod_mpi: an exchange between processes that a launcher of MPI has started. This is the only source
// that uses MPI; processes.h states how the program loads it.
//
// All collective operations are non-blocking ones of MPI, because a process has to notice that another one does not
// arrive, and because it must not use a processor while it waits. Boost.MPI has no such operations, so it only starts
// and ends MPI.
//
// Threads      one at a time: MPI is started with MPI_THREAD_SERIALIZED.
// Source       MPI: A Message-Passing Interface Standard, version 3.1, chapter 5.12.
#include "server/runtime/mpi_component.h"

#include <boost/mpi/communicator.hpp>
#include <boost/mpi/environment.hpp>

#include <mpi.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

namespace evod::runtime {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

// Tags of messages between two ranks.
constexpr int ask_tag = 1, answer_tag = 2;
constexpr std::chrono::seconds answer_patience{5};

class MpiExchange final : public Processes {
  public:
    MpiExchange(std::chrono::seconds patience, bool first_may_rest)
        : environment_{boost::mpi::threading::serialized}
        , patience_{patience}
        , first_may_rest_{first_may_rest}
        , rank_{static_cast<std::uint32_t>(world_.rank())}
        , size_{static_cast<std::uint32_t>(world_.size())} {
        // The messages to one rank that does not receive must not block the others.
        MPI_Comm_dup(world_, &questions_);
        MPI_Comm node = MPI_COMM_NULL;
        MPI_Comm_split_type(world_, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
        int count = 1;
        MPI_Comm_size(node, &count);
        MPI_Comm_free(&node);
        on_this_machine_ = static_cast<std::uint32_t>(count);
        nodes_ = gather(boost::mpi::environment::processor_name());
    }

    std::uint32_t rank() const override { return rank_; }
    std::uint32_t size() const override { return size_; }
    std::uint32_t on_this_machine() const override { return on_this_machine_; }
    std::string name_of(std::uint32_t rank) const override {
        return "rank " + std::to_string(rank) + " on " + nodes_[rank];
    }
    double exchange_s() const override { return std::chrono::duration<double>(Clock::duration{waited_}).count(); }

    std::vector<std::string> gather(std::string part) override {
        const Head head{part};
        std::vector<Head> heads(size_);
        MPI_Request request = MPI_REQUEST_NULL;
        MPI_Iallgather(&head, sizeof head, MPI_BYTE, heads.data(), sizeof head, MPI_BYTE, world_, &request);
        wait(request);
        std::vector<std::string> parts;
        if (std::ranges::all_of(heads, &Head::is_whole)) {
            std::ranges::transform(heads, std::back_inserter(parts), &Head::text);
            return parts;
        }
        std::vector<std::uint64_t> sizes;
        std::ranges::transform(heads, std::back_inserter(sizes), &Head::bytes);
        if (std::accumulate(sizes.begin(), sizes.end(), std::uint64_t{0}) > std::numeric_limits<int>::max()) {
            return swap(std::vector<std::string>(size_, std::move(part)));
        }
        std::vector<int> counts(sizes.begin(), sizes.end()), places(size_);
        std::exclusive_scan(counts.begin(), counts.end(), places.begin(), 0);
        std::string together(static_cast<std::size_t>(places.back() + counts.back()), '\0');
        MPI_Iallgatherv(part.data(), counts[rank_], MPI_CHAR, together.data(), counts.data(), places.data(), MPI_CHAR,
                        world_, &request);
        wait(request);
        for (std::uint32_t from = 0; from < size_; ++from) {
            parts.push_back(together.substr(static_cast<std::size_t>(places[from]), sizes[from]));
        }
        return parts;
    }

    std::vector<std::string> swap(std::vector<std::string> parts) override {
        std::vector<std::uint64_t> sent(size_), received(size_);
        std::ranges::transform(parts, sent.begin(), [](const std::string& part) { return part.size(); });
        MPI_Request request = MPI_REQUEST_NULL;
        MPI_Ialltoall(sent.data(), 1, MPI_UINT64_T, received.data(), 1, MPI_UINT64_T, world_, &request);
        wait(request);
        std::vector<std::string> all(size_);
        for (std::uint32_t from = 0; from < size_; ++from) {
            all[from].resize(received[from]);
        }
        std::vector<MPI_Request> requests;
        for (std::uint32_t distance = 1; distance < size_; ++distance) { // each rank begins with another one
            const std::uint32_t to = (rank_ + distance) % size_, from = (rank_ + size_ - distance) % size_;
            start_pieces(all[from], requests, [&](char* bytes, int count, MPI_Request* begun) {
                MPI_Irecv(bytes, count, MPI_CHAR, static_cast<int>(from), 0, world_, begun);
            });
            start_pieces(parts[to], requests, [&](char* bytes, int count, MPI_Request* begun) {
                MPI_Isend(bytes, count, MPI_CHAR, static_cast<int>(to), 0, world_, begun);
            });
        }
        all[rank_] = std::move(parts[rank_]);
        for (MPI_Request& each : requests) {
            wait(each);
        }
        return all;
    }

    std::string broadcast(std::string from_first) override {
        Head head{from_first};
        MPI_Request request = MPI_REQUEST_NULL;
        MPI_Ibcast(&head, sizeof head, MPI_BYTE, 0, world_, &request);
        if (rank_ > 0 && first_may_rest_) {
            wait_until(request, [](Clock::duration) {});
        } else {
            wait(request);
        }
        if (head.is_whole()) {
            return head.text();
        }
        std::vector<std::string> parts(size_);
        if (rank_ == 0) {
            std::fill(parts.begin(), parts.end(), std::move(from_first));
        }
        return std::move(swap(std::move(parts)).front());
    }

  private:
    /// The beginning of a message, which nearly always is the whole message. Its fixed size makes one operation of MPI
    /// out of two.
    struct Head {
        Head() = default;
        explicit Head(const std::string& message) : bytes{message.size()} {
            std::memcpy(first.data(), message.data(), std::min(message.size(), first.size()));
        }
        bool is_whole() const { return bytes <= first.size(); }
        std::string text() const { return {first.data(), bytes}; }

        std::uint64_t bytes = 0; // of the whole message
        std::array<char, 504> first{};
    };

    /// Calls start() for pieces of `bytes` that are short enough for the int in which MPI counts.
    template <class Start>
    static void start_pieces(std::string& bytes, std::vector<MPI_Request>& requests, Start&& start) {
        constexpr std::size_t piece_bytes_max = std::size_t{1} << 30;
        for (std::size_t done = 0; done < bytes.size(); done += piece_bytes_max) {
            const std::size_t count = std::min(piece_bytes_max, bytes.size() - done);
            start(bytes.data() + done, static_cast<int>(count), &requests.emplace_back(MPI_REQUEST_NULL));
        }
    }

    void wait(MPI_Request& request) {
        const auto begun = Clock::now();
        wait_until(request, [&](Clock::duration waited) {
            if (rank_ == 0 && waited > patience_) {
                name_the_lost(request);
            } else if (waited > patience_ + 2 * answer_patience) {
                give_up(name_of_or_number(0), request);
            }
        });
        waited_ += (Clock::now() - begun).count();
    }

    /// Waits until the request is done. Calls check(time waited so far) from time to time.
    template <class Check>
    void wait_until(MPI_Request& request, Check&& check) {
        const auto begun = Clock::now();
        for (std::uint64_t turn = 0;; ++turn) {
            int done = 0;
            MPI_Test(&request, &done, MPI_STATUS_IGNORE);
            if (done != 0) {
                return;
            }
            if (turn < 200) { // a wait of a few microseconds is not worth a call to the system
                continue;
            }
            const auto waited = Clock::now() - begun;
            // A pause makes a wait at most a quarter longer, and by at most a millisecond while work goes on.
            std::this_thread::sleep_for(std::clamp<Clock::duration>(waited / 4, 5us, waited > 1s ? 5'000us : 1'000us));
            answer_question();
            check(waited);
        }
    }

    std::string name_of_or_number(std::uint32_t rank) const {
        return nodes_.empty() ? "rank " + std::to_string(rank) : name_of(rank);
    }

    /// Answers rank 0, if it asks whether this rank waits, too.
    void answer_question() {
        int is_asked = 0;
        MPI_Iprobe(0, ask_tag, questions_, &is_asked, MPI_STATUS_IGNORE);
        if (rank_ != 0 && is_asked != 0) {
            MPI_Recv(nullptr, 0, MPI_CHAR, 0, ask_tag, questions_, MPI_STATUS_IGNORE);
            MPI_Request request = MPI_REQUEST_NULL;
            MPI_Isend(nullptr, 0, MPI_CHAR, 0, answer_tag, questions_, &request);
            MPI_Request_free(&request);
        }
    }

    /// Asks all other ranks whether they wait. Those that do not answer are lost.
    void name_the_lost(MPI_Request& waited_for) {
        std::vector<bool> waits(size_, false);
        waits[0] = true;
        for (std::uint32_t rank = 1; rank < size_; ++rank) {
            MPI_Request request = MPI_REQUEST_NULL;
            MPI_Isend(nullptr, 0, MPI_CHAR, static_cast<int>(rank), ask_tag, questions_, &request);
            MPI_Request_free(&request);
        }
        const auto end = Clock::now() + answer_patience;
        while (Clock::now() < end && std::ranges::count(waits, false) > 0) {
            int answered = 0;
            MPI_Status status;
            MPI_Iprobe(MPI_ANY_SOURCE, answer_tag, questions_, &answered, &status);
            if (answered != 0) {
                MPI_Recv(nullptr, 0, MPI_CHAR, status.MPI_SOURCE, answer_tag, questions_, MPI_STATUS_IGNORE);
                waits[static_cast<std::size_t>(status.MPI_SOURCE)] = true;
            } else {
                std::this_thread::sleep_for(1ms);
            }
        }
        std::string lost;
        for (std::uint32_t rank = 0; rank < size_; ++rank) {
            if (!waits[rank]) {
                lost += (lost.empty() ? "" : ", ") + name_of_or_number(rank);
            }
        }
        give_up(lost.empty() ? "the network between the ranks" : lost, waited_for);
    }

    void give_up(const std::string& lost, MPI_Request& waited_for) {
        int done = 0;
        MPI_Test(&waited_for, &done, MPI_STATUS_IGNORE);
        if (done != 0) {
            return; // it was late, but arrived; the next MPI_Test of the caller succeeds, too
        }
        std::fprintf(stderr, "evod: %s did not respond for %lld s (--rank-timeout): all ranks end\n", lost.c_str(),
                     static_cast<long long>(patience_.count()));
        std::fflush(nullptr);
        MPI_Abort(world_, exit_rank_lost);
    }

    boost::mpi::environment environment_;
    boost::mpi::communicator world_;
    const std::chrono::seconds patience_;
    const bool first_may_rest_; // the others wait for a broadcast without limit
    const std::uint32_t rank_, size_;
    std::uint32_t on_this_machine_ = 1;
    std::atomic<Clock::rep> waited_ = 0; // ticks of the clock
    MPI_Comm questions_ = MPI_COMM_NULL;
    std::vector<std::string> nodes_; // the name of each rank's machine; empty until all have sent theirs
};

} // namespace
} // namespace evod::runtime

extern "C" const char* evod_mpi_version() {
    return EVOD_VERSION;
}

extern "C" evod::runtime::Processes* evod_mpi_join(long long patience_s, bool first_may_rest) {
    return new evod::runtime::MpiExchange{std::chrono::seconds{patience_s}, first_may_rest};
}
