// ParametersPanel: searches, edits and applies the parameters of the viewed world. The server's registry
// describes the parameters.
//
// ParameterEdits stores the edits and the server's answers. ParametersPanel draws them and sends the requests.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/panels/panel.h"
#include "client/viewer/world/parameter_edits.h"
#include "client/viewer/world/poll.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

class ParametersPanel : public Panel {
  public:
    std::string_view title() const override { return "Parameters"; }
    void build(Context& context) override;

  private:
    void follow(const Context& context);
    void poll(const Context& context);
    void send(const Context& context, std::optional<evod::v1::Request> request);

    void build_head(const Context& context);
    void build_rows(float scale);
    /// A row of the table.
    struct Row {
        std::size_t parameter; // index in the registry
        std::string name;      // the name of its widget for scripts
    };
    void build_row(const Row& row);
    void build_field(const Row& row);
    static void add_label(const Row& row, const evod::v1::ParameterDescription& about);
    // The following functions return whether the user has set a value.
    bool build_flag(const Row& row);
    bool build_number(const Row& row);
    bool build_choice(const Row& row);
    void build_menu(std::size_t i);
    void build_remarks(std::size_t i);

    ParameterEdits edits_;
    std::vector<ParameterGroup> groups_; // the most used parameters, then all by topic
    std::vector<bool> marked_;           // by parameter: whether this frame has a row of it
    std::string world_;                  // the viewed world
    std::string run_id_;                 // the run to which edits_ belong
    std::uint64_t place_number_ = 0, connected_count_ = 0;
    Poll registry_poll_;       // requests the registry until it has arrived
    Poll values_poll_;         // requests the values when they may have changed
    bool stale_ = true;        // the values may have changed
    std::uint64_t change_ = 0; // number of the last request to set values; answers to earlier ones are ignored
    core::SnapshotInterpolator::Clock::time_point sent_{}; // time of this request, which is never sent again
    std::array<char, 64> search_{};
    bool apply_at_once_ = false;
    bool apply_ = false; // apply the edits as soon as no request is pending
};

} // namespace evod::viewer
