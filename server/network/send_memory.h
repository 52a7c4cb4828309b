// SendMemory: counts the memory of all data that waits to be sent to clients, so that one limit applies to all sessions
// together.
//
// If several sessions share the same bytes, these bytes exist once and are counted once.
//
// Owner        the server. The sessions use it on the network thread.
// Full         above `bytes_max` it calls `exceeded`, which must close sessions until enough memory is released.
#pragma once

#include "proto/codec/shared_bytes.h"

#include <cstddef>
#include <functional>
#include <unordered_map>

namespace evod::network {

using codec::SharedBytes;

class SendMemory {
  public:
    /// exceeded  called once when the limit is exceeded. It is called again only after rearm(). It must not release
    ///           memory before it returns.
    SendMemory(std::size_t bytes_max, std::function<void()> exceeded)
        : bytes_max_{bytes_max}, exceeded_{std::move(exceeded)} {}

    /// A reference to shared bytes. SendMemory counts the bytes as long as a reference exists.
    class Counted {
      public:
        Counted() = default;
        Counted(SendMemory& owner, SharedBytes bytes);
        Counted(Counted&& other) noexcept;
        Counted& operator=(Counted&& other) noexcept;
        ~Counted() { release(); }

        explicit operator bool() const { return bytes_ != nullptr; }
        const std::string& operator*() const { return *bytes_; }
        const std::string* operator->() const { return bytes_.get(); }

        /// The number of bytes divided by the number of objects that share them.
        std::size_t share() const;

      private:
        void release();
        SendMemory* owner_ = nullptr;
        SharedBytes bytes_;
    };

    /// Memory that only one session uses. set() changes its size.
    class Reservation {
      public:
        explicit Reservation(SendMemory& owner) : owner_{owner} {}
        Reservation(const Reservation&) = delete;
        ~Reservation() { set(0); }
        void set(std::size_t bytes);
        std::size_t bytes() const { return bytes_; }

      private:
        SendMemory& owner_;
        std::size_t bytes_ = 0;
    };

    std::size_t bytes() const { return bytes_; }
    /// Number of bytes by which the limit is exceeded.
    std::size_t excess() const { return bytes_ > bytes_max_ ? bytes_ - bytes_max_ : 0; }
    /// Allows `exceeded` to be called again.
    void rearm() { reported_ = false; }

  private:
    void add(std::size_t bytes);

    const std::size_t bytes_max_;
    const std::function<void()> exceeded_;
    std::unordered_map<const std::string*, std::size_t> holders_;
    std::size_t bytes_ = 0;
    bool reported_ = false;
};

} // namespace evod::network
