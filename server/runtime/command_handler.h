// Command handler: applies commands between two ticks, constructs their worlds, and records and answers them.
//
// Owner        a simulation loop, on its thread.
// Builds       another thread constructs large worlds (world_builds.h). Meanwhile the commands to them are kept.
// Forks        fork.h describes them. Worlds that the loop of the replays computes for them come as mail.
#pragma once

#include "server/recording/recorder.h"
#include "server/runtime/loop_outputs.h"
#include "server/runtime/pace.h"
#include "server/runtime/run_finder.h"
#include "server/runtime/storage_watch.h"
#include "server/runtime/world_builds.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace evod::runtime {

class CommandHandler {
  public:
    /// All arguments must outlive this object. recorder: nullptr if runs are not stored.
    CommandHandler(const LoopTools& tools, simulation::Laboratory& laboratory, recording::Recorder* recorder,
                   const LoopOutputs& outputs, WorldBuilds& builds, StorageWatch& storage, RunFinder& runs)
        : tools_{tools}
        , laboratory_{laboratory}
        , recorder_{recorder}
        , outputs_{outputs}
        , builds_{builds}
        , storage_{storage}
        , runs_{runs} {}

    void handle(CommandMail& mail);
    void handle(const ForEachWorld& mail);
    void handle(const SetClass& mail);
    /// Handles the mail of the build thread.
    void take(const WorldBuilt& built);
    // Handle the mail about the worlds that come from the loop of the replays.
    void take(ForkAnnounced& announced) { announced_forks_.push_back(std::move(announced)); }
    void take(ForkWorldComputed& computed);
    /// Returns the worlds that commands have changed since the last call.
    std::vector<std::string> take_changed() { return std::exchange(changed_, {}); }

  private:
    base::Result<simulation::Applied> apply(const simulation::Command& command);
    /// Whether the command must wait because one of its worlds is being built or is an announced fork.
    bool waits_for_a_world(const simulation::Command& command) const;
    /// Whether the world is an announced fork. With an empty name: whether a fork comes soon, because the meaning of an
    /// empty name may then change.
    bool is_announced_fork(std::string_view world) const;
    /// Handles the commands that waited.
    void handle_kept();
    void adopt(ForkWorldComputed& computed);
    /// The run of the command's world before the command was applied.
    struct RunBefore {
        simulation::RunId run_id;
        std::uint64_t tick;
    };
    std::optional<RunBefore> run_before(const simulation::Command& command) const;
    void fork(CommandMail& mail);
    /// Constructs the world of a command of type C (CreateWorld, ResetWorld or ForkWorld), adopts it and answers.
    template <class C>
    void construct(CommandMail& mail, const std::optional<RunBefore>& before,
                   base::Result<simulation::Construction> construction);
    const simulation::Entry* entry_of_command(const simulation::Command& command) const;
    /// Returns why the sender may not send the command; nullopt if the sender may, or if there is no such world.
    std::optional<base::Refusal> refusal_of_sender(CommandMail& mail) const;
    /// Returns why the journal cannot store this command now; nullopt if it can, or if the command need not be stored.
    std::optional<base::Refusal> refusal_of(const simulation::Command& command) const;
    /// beginning  of the run that the command began; nullopt if it began none, or if runs are not stored.
    void answer(CommandMail& mail, const base::Result<simulation::Applied>& applied,
                const std::optional<RunBefore>& before, std::optional<run_file::RunBeginning> beginning = {});
    /// Builds the answer to a command, and the data about its effect that the network thread needs.
    CommandDone done_of(CommandMail mail, const base::Result<simulation::Applied>& applied) const;
    /// Writes an applied command to the journal.
    void record(CommandDone done, const std::optional<RunBefore>& before,
                std::optional<run_file::RunBeginning> beginning);

    const LoopTools tools_;
    simulation::Laboratory& laboratory_;
    recording::Recorder* const recorder_;
    const LoopOutputs& outputs_;
    WorldBuilds& builds_;
    StorageWatch& storage_;
    RunFinder& runs_;
    std::vector<ForkAnnounced> announced_forks_; // forks whose worlds are on their way
    std::vector<CommandMail> kept_; // commands to worlds that builds hold or that are announced, in order of arrival
    std::vector<std::string> changed_;
};

} // namespace evod::runtime
