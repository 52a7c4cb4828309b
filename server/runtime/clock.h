// Clock: the source of time for all code outside the core. Tests set the time. The core reads no clock.
#pragma once

#include <chrono>

namespace evod::runtime {

class Clock {
  public:
    using duration = std::chrono::steady_clock::duration;
    using time_point = std::chrono::steady_clock::time_point;

    virtual ~Clock() = default;
    virtual time_point now() = 0;
};

class SteadyClock final : public Clock {
  public:
    time_point now() override { return std::chrono::steady_clock::now(); }
};

} // namespace evod::runtime
