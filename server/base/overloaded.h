// Overloaded: combines lambdas, one per alternative of a variant, into one visitor.
#pragma once

namespace evod::base {

template <class... F>
struct Overloaded : F... {
    using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>; // clang 14 does not deduce it by itself

} // namespace evod::base
