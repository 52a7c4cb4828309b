#include "server/network/class_events.h"

#include "server/classes/membership.h"
#include "server/network/messages.h"

#include <utility>

namespace evod::network {

bool may_manage(const Session& session, const classes::Class& of) {
    const access::AuthenticatedUser& user = session.user();
    return user.role >= access::Role::Controller || (user.role == access::Role::Teacher && user.name == of.teacher);
}

void ClassEvents::changed(const std::string& class_name) {
    if (!changed_.insert(class_name).second || changed_.size() > 1) {
        return; // the timer runs already
    }
    timer_.expires_after(pause);
    timer_.async_wait([this](boost::system::error_code error) {
        if (error) {
            return;
        }
        for (const std::string& name : std::exchange(changed_, {})) {
            if (const classes::Class* of = classes::find(registry_.classes(), name)) {
                publish(*of);
            }
        }
    });
}

void ClassEvents::all_changed() {
    for (const auto& [name, of] : registry_.classes()) {
        changed(name);
    }
}

void ClassEvents::deleted(const classes::Class& of) {
    publish(of);
}

void ClassEvents::publish(const classes::Class& of) const {
    v1::Event event;
    event.mutable_class_changed()->set_class_(of.name);
    const SharedBytes frame = encode_event(std::move(event));
    for (const auto& [number, session] : sessions_) {
        if (session->greeted() && !session->events.empty() && may_manage(*session, of)) {
            session->event(frame);
        }
    }
}

} // namespace evod::network
