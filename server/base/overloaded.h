// Overloaded: one visitor of a variant made of a lambda per alternative.
#pragma once

namespace evod::base {

template <class... F>
struct Overloaded : F... {
    using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>; // clang 14 does not deduce it by itself

} // namespace evod::base
