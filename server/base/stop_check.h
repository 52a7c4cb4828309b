// Stop check: long work calls it often, for example after every tick, and ends if the answer is true. The call may take
// a while, because the work of others may have its turn meanwhile.
#pragma once

#include <functional>
#include <utility>

namespace evod::base {

class StopCheck {
  public:
    /// The work is never stopped.
    StopCheck() = default;
    explicit StopCheck(std::function<bool()> is_stopped) : is_stopped_{std::move(is_stopped)} {}

    bool operator()() const { return is_stopped_ && is_stopped_(); }

  private:
    std::function<bool()> is_stopped_;
};

} // namespace evod::base
