// InlineExecutor: runs every piece on the calling thread, in index order.
#pragma once

#include "server/base/executor.h"

#include <algorithm>

namespace evod::support {

class InlineExecutor final : public base::Executor {
  public:
    std::size_t thread_count() const override { return 1; }

  protected:
    void run(std::size_t count, std::size_t grain, base::FunctionRef<void(base::Range)> body) override {
        for (std::size_t begin = 0; begin < count; begin += grain)
            body({begin, std::min(begin + grain, count)});
    }
};

} // namespace evod::support
