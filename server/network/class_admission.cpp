#include "server/network/class_admission.h"

#include "server/classes/codes.h"
#include "server/log/log.h"

#include <cmath>
#include <string>
#include <utility>

namespace evod::network {

using base::Reason;
using base::RefusalCode;
using base::Result;

base::Refusal removed_refusal(const std::string& class_name) {
    return refusal(RefusalCode::Unauthenticated, "the teacher has removed this member: ask your teacher",
                   Reason::MemberRemoved, {{"class", class_name}});
}

std::optional<Result<AdmittedMember>> ClassAdmission::admit(const v1::Hello& hello) {
    if (hello.has_join()) {
        return join(hello.join());
    }
    if (hello.token().empty()) {
        return std::nullopt;
    }
    const auto found = classes::find_by_token(registry_.classes(), hello.token());
    if (!found) {
        return std::nullopt;
    }
    if (found->member->removed) {
        return removed_refusal(found->of->name);
    }
    services_.create_world(*found->of, *found->member);
    events_.changed(found->of->name);
    return admitted(*found->of, *found->member, {});
}

Result<AdmittedMember> ClassAdmission::join(const v1::Join& join) {
    const auto code = classes::normalised_code(join.code());
    if (!code) {
        return wrong_code();
    }
    if (const auto found = classes::find_by_personal_code(registry_.classes(), *code)) {
        if (found->member->removed) {
            return removed_refusal(found->of->name);
        }
        return join_as(*found->of, found->member->number);
    }
    const classes::Class* of = classes::find_by_code(registry_.classes(), *code, services_.now_s());
    if (of == nullptr) {
        return wrong_code();
    }
    classes::Class next = *of;
    const auto member = classes::add_member(next, join.name(), "hello.join.name", services_.draw);
    if (!member) {
        return member.error();
    }
    const std::uint32_t number = (*member)->number;
    return join_as(std::move(next), number);
}

Result<AdmittedMember> ClassAdmission::join_as(classes::Class of, std::uint32_t number) {
    classes::Member& member = *classes::find(of, number);
    const std::string token = classes::add_token(member, services_.draw);
    member.joined = true;
    const std::string name = of.name;
    if (auto stored = registry_.store(std::move(of)); !stored) {
        return stored.error();
    }
    classes::Class now = *classes::find(registry_.classes(), name);
    const classes::Member& joined = *classes::find(now, number);
    services_.create_world(now, joined);
    events_.changed(name);
    return admitted(now, joined, token);
}

AdmittedMember ClassAdmission::admitted(const classes::Class& of, const classes::Member& member,
                                        const std::string& token) const {
    AdmittedMember to;
    to.user = {.name = classes::user_of(of, member), .role = access::Role::Viewer, .is_member = true};
    to.membership.set_class_(of.name);
    to.membership.set_name(member.name);
    to.membership.set_world(classes::world_of(of, member));
    to.membership.set_lesson(of.lesson);
    to.membership.set_teacher(of.teacher);
    to.membership.set_token(token);
    return to;
}

base::Refusal ClassAdmission::wrong_code() {
    const auto now = host_.clock->now();
    if (!wrong_codes_) {
        wrong_codes_.emplace(wrong_codes_per_s, wrong_codes_burst, now);
    }
    if (wrong_codes_->take(1, now)) {
        return refusal(RefusalCode::Unauthenticated, "this class is not open: ask your teacher for a new code",
                       Reason::CodeUnknown);
    }
    host_.limit_counters.met(Limit::WrongCodes);
    if (!std::exchange(guessed_, true)) {
        log::warn("codes of classes may be guessed: more than {} wrong ones per second", wrong_codes_per_s);
        events_.all_changed();
    }
    calm_.expires_after(warned_for);
    calm_.async_wait([this](boost::system::error_code error) {
        if (!error) {
            guessed_ = false;
            events_.all_changed();
        }
    });
    const std::string wait = std::to_string(static_cast<int>(std::ceil(wrong_codes_burst / wrong_codes_per_s)));
    return refusal(RefusalCode::ResourceExhausted,
                   "the server got too many wrong codes: check the code, and try again in " + wait + " s",
                   Reason::JoinsTooFast, {{"retry_after_s", wait}});
}

} // namespace evod::network
