// Buffers: the memory of everything that waits for all clients together, so that it can have one bound.
//
// Bytes that several sessions are to be sent are there once, and are counted once.
//
// Owner        the server; used by its sessions on the network thread.
// Full         at most `bytes_max`: then `over` is called, and has to see to it that some are let go.
#pragma once

#include "proto/codec/shared_bytes.h"

#include <cstddef>
#include <functional>
#include <unordered_map>

namespace evod::network {

using codec::SharedBytes;

class Buffers {
  public:
    /// over  called once when there are too many, and again only after relieved(); must not let go of any by itself.
    Buffers(std::size_t bytes_max, std::function<void()> over) : bytes_max_{bytes_max}, over_{std::move(over)} {}

    /// Bytes that are held for somebody, for as long as this lives.
    class Held {
      public:
        Held() = default;
        Held(Buffers& buffers, SharedBytes bytes);
        Held(Held&& other) noexcept;
        Held& operator=(Held&& other) noexcept;
        ~Held() { let_go(); }

        explicit operator bool() const { return bytes_ != nullptr; }
        const std::string& operator*() const { return *bytes_; }
        const std::string* operator->() const { return bytes_.get(); }

        /// What one of all who hold them accounts for.
        std::size_t share() const;

      private:
        void let_go();
        Buffers* buffers_ = nullptr;
        SharedBytes bytes_;
    };

    /// Memory of somebody's own, as much as it was last said to be.
    class Own {
      public:
        explicit Own(Buffers& buffers) : buffers_{buffers} {}
        Own(const Own&) = delete;
        ~Own() { set(0); }
        void set(std::size_t bytes);
        std::size_t bytes() const { return bytes_; }

      private:
        Buffers& buffers_;
        std::size_t bytes_ = 0;
    };

    std::size_t bytes() const { return bytes_; }
    /// How many there are too many.
    std::size_t excess() const { return bytes_ > bytes_max_ ? bytes_ - bytes_max_ : 0; }
    /// It is to be told again when there are too many.
    void relieved() { told_ = false; }

  private:
    void add(std::size_t bytes);

    const std::size_t bytes_max_;
    const std::function<void()> over_;
    std::unordered_map<const std::string*, std::size_t> holders_;
    std::size_t bytes_ = 0;
    bool told_ = false;
};

} // namespace evod::network
