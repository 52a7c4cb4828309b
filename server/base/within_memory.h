// Within memory: runs a function that may need much memory, and returns a refusal if there is not enough.
#pragma once

#include "server/base/result.h"

#include <new>

namespace evod::base {

/// Returns the Result of `work`, or ResourceExhausted if memory does not suffice.
///
/// work  must allocate all its memory before it changes anything that outlives it.
template <class Work>
auto within_memory(Work&& work) -> decltype(work()) {
    try {
        return work();
    } catch (const std::bad_alloc&) {
        return refusal(RefusalCode::ResourceExhausted,
                       "not enough memory: nothing was changed; request less, or delete a world first");
    }
}

} // namespace evod::base
