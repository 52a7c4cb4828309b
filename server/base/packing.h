// Packing: values as bytes, for processes that run the same program on the same kind of machine (exchange.h), and for
// parts of files whose layout does not change.
//
// Numbers, and structs of numbers, are packed as they are in memory; strings and vectors as the number of their
// elements and the elements; variants as the index of their alternative and its value; other structs field by field.
#pragma once

#include "server/base/assert.h"

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace evod::base {

/// The fields of a struct that is not packed as it is in memory. The struct declares them once, for both directions, in
/// a static function; `route` is const while it is packed:
///
///     static void visit(auto& route, auto&& each) { each(route.from, route.stops); }
///
/// For structs of other folders, a specialisation contains the function.
template <class T>
struct Fields {
    static void visit(auto& value, auto&& each) { T::visit(value, each); }
};

/// std::string, std::vector, Column.
template <class T>
concept List = requires(T list) {
    list.push_back(typename T::value_type{});
};

class Packer {
  public:
    template <class T>
    void add(const T& value) {
        if constexpr (std::is_trivially_copyable_v<T>) {
            bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
        } else if constexpr (List<T>) {
            add(std::uint64_t{value.size()});
            if constexpr (std::is_trivially_copyable_v<typename T::value_type>) {
                add(std::span{value});
            } else {
                for (const auto& element : value) {
                    add(element);
                }
            }
        } else if constexpr (requires { value.has_value(); }) { // std::optional
            add(value.has_value());
            if (value) {
                add(*value);
            }
        } else {
            Fields<T>::visit(value, [&](const auto&... fields) { (add(fields), ...); });
        }
    }
    template <class... Alternatives>
    void add(const std::variant<Alternatives...>& value) {
        add(std::uint64_t{value.index()});
        std::visit([&](const auto& alternative) { add(alternative); }, value);
    }
    /// Appends the values, without their number.
    template <class T>
    void add(std::span<T> values) {
        bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
    }

    std::string take() { return std::exchange(bytes_, {}); }

  private:
    std::string bytes_;
};

/// Reads what a Packer has written, in the same order. Does not own the bytes.
class Unpacker {
  public:
    explicit Unpacker(std::string_view bytes) : rest_{bytes} {}

    template <class T>
    void read(T& value) {
        if constexpr (std::is_trivially_copyable_v<T>) {
            read(std::span{&value, 1});
        } else if constexpr (List<T>) {
            using Element = typename T::value_type;
            const auto count = next<std::uint64_t>();
            if constexpr (std::is_trivially_copyable_v<Element>) {
                EVOD_ASSERT(count <= rest_.size() / sizeof(Element));
                value.resize(count);
                read(std::span{value});
            } else {
                EVOD_ASSERT(count <= rest_.size()); // no element is empty
                value.resize(count);
                for (auto& element : value) {
                    read(element);
                }
            }
        } else if constexpr (requires { value.has_value(); }) { // std::optional
            value.reset();
            if (next<bool>()) {
                read(value.emplace());
            }
        } else {
            Fields<T>::visit(value, [&](auto&&... fields) { (read(fields), ...); });
        }
    }
    template <class... Alternatives>
    void read(std::variant<Alternatives...>& value) {
        const auto index = next<std::uint64_t>();
        EVOD_ASSERT(index < sizeof...(Alternatives));
        std::uint64_t alternative = 0;
        ((alternative++ == index ? read(value.template emplace<Alternatives>()) : void()), ...);
    }
    template <class T>
    void read(std::span<T> values) {
        EVOD_ASSERT(values.size_bytes() <= rest_.size());
        if (!values.empty()) {
            std::memcpy(values.data(), rest_.data(), values.size_bytes());
        }
        rest_.remove_prefix(values.size_bytes());
    }
    template <class T>
    T next() {
        T value{};
        read(value);
        return value;
    }
    bool empty() const { return rest_.empty(); }

  private:
    std::string_view rest_;
};

template <class T>
std::string pack(const T& value) {
    Packer packer;
    packer.add(value);
    return packer.take();
}
/// Reads what pack() has returned. The bytes must contain a T and nothing else.
template <class T>
T unpack(std::string_view bytes) {
    Unpacker unpacker{bytes};
    T value = unpacker.next<T>();
    EVOD_ASSERT(unpacker.empty());
    return value;
}

} // namespace evod::base
