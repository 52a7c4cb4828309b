#include "server/runtime/unwritten_replies.h"

#include "server/base/assert.h"
#include "server/base/overloaded.h"
#include "server/replay/recovery.h"

#include <utility>

namespace evod::runtime {

std::optional<Answer> UnwrittenReplies::pass(Reply reply) {
    return std::visit(base::Overloaded{
                          [this](recording::Receipt& receipt) -> std::optional<Answer> {
                              auto waited = waiting_.extract(receipt.ticket);
                              EVOD_ASSERT(!waited.empty());
                              Answer answer = std::move(waited.mapped());
                              if (auto* done = std::get_if<CommandDone>(&answer); done && receipt.refused) {
                                  const std::string world = done->outcome->world;
                                  return refused(std::move(*done),
                                                 replay::damaged_world(world, {}, *receipt.refused).refusal());
                              }
                              return answer;
                          },
                          [this](auto& done) -> std::optional<Answer> {
                              if constexpr (requires { done.ticket; }) {
                                  if (done.ticket != 0) {
                                      const recording::Ticket ticket = std::exchange(done.ticket, 0);
                                      waiting_.emplace(ticket, std::move(done));
                                      return std::nullopt;
                                  }
                              }
                              return std::move(done);
                          },
                      },
                      reply);
}

} // namespace evod::runtime
