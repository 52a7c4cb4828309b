// ParametersPanel: every parameter of the world that is looked at, as the server's registry describes it, to be
// searched, changed, applied and undone.
//
// What is being changed and what comes of it is ParameterEdits' affair; this draws it, and carries its requests.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panels/panel.h"
#include "client/viewer/world/parameter_edits.h"
#include "client/viewer/world/poll.h"

#include <array>
#include <optional>
#include <string>

namespace evod::viewer {

class ParametersPanel : public Panel {
  public:
    std::string_view title() const override { return "Parameters"; }
    Size first_size() const override { return {560, 600}; }
    std::span<const Key> keys() const override;
    void build(Context& context) override;

  private:
    void follow(const Context& context);
    void ask(const Context& context);
    void send(const Context& context, std::optional<evod::v1::Request> request);

    void build_head(const Context& context, bool may);
    void build_rows(float scale);
    void build_row(std::size_t i);
    void build_field(std::size_t i);
    bool build_number(std::size_t i);
    bool build_choice(std::size_t i);
    void build_menu(std::size_t i);
    void build_remarks(std::size_t i);

    ParameterEdits edits_;
    std::vector<ParameterGroup> groups_;
    std::string world_;  // by the name that was asked for
    std::string run_id_; // that the undo stack is of
    std::uint64_t place_number_ = 0, connected_count_ = 0;
    Poll registry_poll_;                        // until it is known
    Poll values_poll_;                          // when they may have changed
    bool stale_ = true;                         // the values
    std::uint64_t transaction_ = 0;             // number of the last: an answer to another is late
    core::WorldView::Clock::time_point sent_{}; // the last; it is never sent twice
    std::array<char, 64> search_{};
    bool apply_on_release_ = false;
    bool apply_ = false; // as soon as no transaction is under way
};

} // namespace evod::viewer
