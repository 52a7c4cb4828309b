// Executor: runs the pieces of a parallel loop for the core. The core receives an executor and never creates one.
//
// Threads      parallel_for returns after every piece has run; a piece touches only the data it was given.
// Determinism  no result may depend on which thread runs which piece. The caller combines partial results, one per
//              block of fixed size, in index order.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

namespace evod::base {

/// A non-owning reference to a callable, as cheap to copy as two pointers. Valid only while the callable exists.
template <class Signature>
class FunctionRef;

template <class R, class... Arguments>
class FunctionRef<R(Arguments...)> {
  public:
    template <class F>
    requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef>)
        FunctionRef(F&& function) // NOLINT(bugprone-forwarding-reference-overload): constrained above
        : object_{const_cast<void*>(static_cast<const void*>(std::addressof(function)))}
        , call_{[](void* object, Arguments... arguments) -> R {
            return (*static_cast<std::remove_reference_t<F>*>(object))(arguments...);
        }} {}

    R operator()(Arguments... arguments) const { return call_(object_, arguments...); }

  private:
    void* object_;
    R (*call_)(void*, Arguments...);
};

/// The range of indices [begin, end) of one piece of a parallel loop.
struct Range {
    std::size_t begin, end;
};

class Executor {
  public:
    virtual ~Executor() = default;

    /// Runs `body` over [0, count) in pieces of at most `grain` indices (grain >= 1), cut at multiples of `grain`.
    /// Returns when all pieces have run. A piece may call parallel_for() too. If there is only one piece, it runs on
    /// the calling thread.
    void parallel_for(std::size_t count, std::size_t grain, FunctionRef<void(Range)> body) {
        if (count == 0) {
            return;
        }
        if (count <= grain) {
            body({0, count});
        } else {
            run(count, grain, body);
        }
    }

    /// Returns the number of threads that may work at the same time, >= 1. Use it to decide whether to cut a loop,
    /// never where to cut it: results must not depend on it.
    virtual std::size_t thread_count() const = 0;

  protected:
    virtual void run(std::size_t count, std::size_t grain, FunctionRef<void(Range)> body) = 0;
};

} // namespace evod::base
