// Class events: sends ClassChanged to the sessions that may know, at most a few times per second for each class.
//
// Owner        the dispatcher, on the network thread.
#pragma once

#include "server/classes/registry.h"
#include "server/network/session.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <set>
#include <string>

namespace evod::network {

/// Whether a session may read and change a class: that of its teacher, of a controller or of an admin.
bool may_manage(const Session& session, const classes::Class& of);

class ClassEvents {
  public:
    static constexpr std::chrono::milliseconds pause{250}; // between two events about the same class

    /// All arguments must outlive this object.
    ClassEvents(asio::io_context& context, const classes::Registry& registry, const Sessions& sessions)
        : registry_{registry}, sessions_{sessions}, timer_{context} {}

    /// Must be called when a class was created or has changed, and when one of its members has connected or gone.
    void changed(const std::string& class_name);
    void all_changed();
    /// Must be called when a class was deleted.
    ///
    /// of  the class before.
    void deleted(const classes::Class& of);

  private:
    void publish(const classes::Class& of) const;

    const classes::Registry& registry_;
    const Sessions& sessions_;
    asio::steady_timer timer_;
    std::set<std::string> changed_; // since the timer was started
};

} // namespace evod::network
