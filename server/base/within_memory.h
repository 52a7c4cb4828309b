// Within memory: work that needs much memory at once, and is refused where there is not enough.
#pragma once

#include "server/base/result.h"

#include <new>

namespace evod::base {

/// What `work` returns, a Result; refused as ResourceExhausted if memory does not suffice for it.
///
/// work  changes nothing that outlives it before it has all the memory it needs.
template <class Work>
auto within_memory(Work&& work) -> decltype(work()) {
    try {
        return work();
    } catch (const std::bad_alloc&) {
        return refusal(
            RefusalCode::ResourceExhausted,
            "there is not enough memory for that: nothing was changed; ask for less, or delete a world first");
    }
}

} // namespace evod::base
