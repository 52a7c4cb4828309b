#include "server/runtime/replies.h"

#include "server/protocol/answers.h"

#include <utility>

namespace evod::runtime {

CommandDone refused(CommandDone done, base::Refusal why) {
    const simulation::Laboratory no_worlds; // a refusal reads none
    done.outcome = std::move(why);
    done.frame = protocol::frame_of(
        protocol::answer_of(done.mail.origin.request_id, done.mail.request_name, no_worlds, done.outcome));
    done.event.reset();
    done.fork.reset();
    return done;
}

base::Refusal replay_taken_back() {
    return refusal(base::RefusalCode::ResourceExhausted,
                   "another user needs the place of this replay, and this user has the most replays: try again later",
                   base::Reason::ReplaysMax);
}

} // namespace evod::runtime
