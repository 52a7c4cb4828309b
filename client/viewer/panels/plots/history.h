// History: the statistics of all finished generations of a run that the server still has, kept up to date.
//
// Earlier generations are requested page by page; events add each generation that ends. After a possible loss (dropped
// events, a broken connection, a hidden panel) the missing part is requested again. Another run clears the history.
//
// Owner        PlotsPanel.
// Threads      none.
#pragma once

#include "client/viewer/panels/plots/history_table.h"
#include "evod/v1/session.pb.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

class History {
  public:
    /// Sets the run; clears the history if the world or the run has changed.
    void see_run(const std::string& world, const std::string& run_id);
    void see_run(const evod::v1::WorldInfo& world);

    /// Processes an event; ignores events of other worlds.
    void see_event(const evod::v1::Event& event);

    /// Generations of this run up to `generation` have ended, according to a snapshot.
    void see_ended(std::uint64_t generation);

    /// Events may have been missed.
    void refresh() { missing_ = again_ = true; }

    struct Query {
        std::uint64_t number; // for receive()
        evod::v1::Request request;
    };
    /// The query to send now; nullopt if nothing is missing or an answer is pending. The caller then calls receive() or
    /// cancel() once.
    std::optional<Query> next_query();

    /// The answer to a query; null if the query failed, which is then sent again.
    void receive(std::uint64_t number, const evod::v1::History* answer);

    /// Whether an answer is pending.
    bool pending() const { return asked_ != answered_; }
    /// Drops the pending query; its answer will be ignored.
    void cancel();

    /// Names the genes of the run; ignores an empty list.
    void set_gene_names(const std::vector<std::string>& names);

    const std::string& world() const { return world_; }
    const std::string& run_id() const { return run_id_; }
    /// Whether the table has every generation known to have ended.
    bool complete() const { return !run_id_.empty() && !missing_; }
    const HistoryTable& table() const { return table_; }
    /// Changes whenever the table does.
    std::uint64_t revision() const { return revision_; }

  private:
    template <class Generations>
    void add(const Generations& generations);

    std::string world_, run_id_;
    HistoryTable table_;
    std::uint64_t whole_until_ = 0; // the table has all that the server knows up to here
    bool missing_ = true;
    bool again_ = false;                     // something was missed since the last query
    std::uint64_t asked_ = 0, answered_ = 0; // numbers of queries
    std::uint64_t ended_ = 0;                // the last generation that is known to have ended
    std::uint64_t ended_when_asked_ = 0;     // the same when the first page was requested
    std::optional<std::uint64_t> next_page_;
    std::uint64_t revision_ = 0;
};

} // namespace evod::viewer
