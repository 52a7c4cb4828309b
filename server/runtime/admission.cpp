#include "server/runtime/admission.h"

namespace evod::runtime {

std::optional<base::Refusal> admit(CommandMail& mail, const simulation::Entry* world) {
    if (mail.rules == nullptr) {
        return std::nullopt;
    }
    const simulation::Ownership no_user;
    const access::RequestedWorld requested{world != nullptr ? world->ownership : no_user,
                                           world != nullptr && world->frozen};
    if (const auto permitted = access::may(mail.requester, *mail.rules, mail.request_name, &requested); !permitted) {
        return permitted.error();
    }
    if (auto* created = std::get_if<simulation::CreateWorld>(&mail.command)) {
        created->ownership = {.user = mail.requester.user, .class_name = {}, .teacher = {}};
    } else if (auto* fork = std::get_if<simulation::ForkWorld>(&mail.command)) {
        fork->ownership = access::owns(mail.requester, requested.ownership) ? requested.ownership : no_user;
        fork->ownership.user = mail.requester.user;
    }
    return std::nullopt;
}

} // namespace evod::runtime
