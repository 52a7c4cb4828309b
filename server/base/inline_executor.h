// InlineExecutor: runs every piece on the calling thread, in index order. For programs with one thread, and for tests.
#pragma once

#include "server/base/executor.h"

#include <algorithm>

namespace evod::base {

class InlineExecutor final : public Executor {
  public:
    std::size_t thread_count() const override { return 1; }

  protected:
    void run(std::size_t count, std::size_t grain, FunctionRef<void(Range)> body) override {
        for (std::size_t begin = 0; begin < count; begin += grain) {
            body({begin, std::min(begin + grain, count)});
        }
    }
};

} // namespace evod::base
