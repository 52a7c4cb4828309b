#include "server/network/class_requests.h"

#include "proto/text/suggestion.h"
#include "server/base/exact_number.h"
#include "server/classes/names.h"
#include "server/classes/qr_code.h"
#include "server/classes/ranges.h"
#include "server/log/log.h"
#include "server/protocol/commands.h"
#include "server/protocol/parameters.h"
#include "server/protocol/refusals.h"
#include "server/protocol/request_rules.h"
#include "server/runtime/random_ids.h"
#include "server/simulation/world_name.h"

#include <boost/asio/post.hpp>

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

namespace evod::network {
namespace {

using base::Reason;
using base::RefusalCode;
using base::Result;
using base::Violation;
using classes::Class;
using classes::Member;
using Violations = std::vector<Violation>;

constexpr std::size_t template_bytes_max = 256 << 10, qr_codes_max = 100;
constexpr std::chrono::milliseconds busy_pause{100}; // before a world is created for which the mailbox had no place

std::int64_t system_time_s() {
    return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

void check_lesson(const std::string& lesson, const std::string& field, Violations& violations) {
    if (!lesson.empty() && !simulation::is_world_name(lesson)) {
        violations.push_back(
            {field, "the name of a lesson (" + std::string{simulation::world_name_allowed} + "), or nothing", lesson});
    }
}

void check_worlds_max(std::uint32_t count, const std::string& field, Violations& violations) {
    if (count < classes::member_worlds_least || count > classes::member_worlds_most) {
        violations.push_back(
            {field, std::to_string(classes::member_worlds_least) + " to " + std::to_string(classes::member_worlds_most),
             std::to_string(count)});
    }
}

simulation::ClassRules rules_of(const Class& of) {
    return {.frozen = of.frozen, .ranges = of.ranges, .worlds_per_member = of.member_worlds_max};
}

/// Checks the world of each member, and returns it as the registry stores it: with a seed.
std::string template_of(const v1::CreateWorld& given, const Class& of, Violations& violations) {
    const std::string path = "create_class.template";
    if (!given.name().empty()) {
        violations.push_back({path + ".name", "nothing; the server names the worlds", '"' + given.name() + '"'});
    }
    if (given.ByteSizeLong() > template_bytes_max) {
        violations.push_back({path, "at most " + std::to_string(template_bytes_max) + " bytes",
                              std::to_string(given.ByteSizeLong()) + " bytes"});
        return {};
    }
    v1::Request request;
    v1::CreateWorld& world = *request.mutable_create_world();
    world = given;
    world.set_name("world");
    request.set_client_key("template"); // a command must have one
    const auto command = protocol::to_command(request, {runtime::draw_seed(), runtime::draw_run_id()});
    if (!command) {
        Violations without_value;
        const auto assignments = protocol::to_assignments(given.parameters(), path + ".", without_value);
        const Violations outside = simulation::values_outside(rules_of(of), of.name, assignments, path + ".");
        violations.insert(violations.end(), outside.begin(), outside.end());
        for (Violation violation : command.error().violations) {
            if (const std::string old = "create_world"; violation.field.starts_with(old)) {
                violation.field = path + violation.field.substr(old.size());
            }
            if (std::ranges::find(outside, violation.field, &Violation::field) == outside.end()) {
                violations.push_back(std::move(violation));
            }
        }
        return {};
    }
    const auto& create = std::get<simulation::CreateWorld>(*command);
    classes::check_ranges(of.ranges, create.parameters, create.schedule, of.name, path, violations);
    world.clear_name();
    world.set_seed(create.seed.value);
    return world.SerializeAsString();
}

/// The command that creates the world of a member.
v1::Request creation_of(const Class& of, const Member& member) {
    v1::Request request;
    v1::CreateWorld& world = *request.mutable_create_world();
    world.ParseFromString(of.world_template);
    world.set_name(classes::world_of(of, member));
    if (of.own_seeds) {
        const base::RandomKey key{base::Seed{world.seed()}, base::Purpose::ClassMember, 0, 0};
        world.set_seed(base::portable_seed(base::RandomStream{key, member.number}.long_word()).value);
    }
    return request;
}

v1::Response answer_of(std::uint64_t request_id, const v1::ClassInfo& info) {
    v1::Response response = response_to(request_id);
    *response.mutable_class_info() = info;
    return response;
}

} // namespace

ClassRequests::ClassRequests(asio::io_context& context, classes::Registry& registry, const Sessions& sessions,
                             SessionHost& host, ClassActions actions, classes::Draw draw)
    : context_{context}
    , registry_{registry}
    , sessions_{sessions}
    , actions_{std::move(actions)}
    , services_{.draw = std::move(draw),
                .now_s = system_time_s,
                .create_world = [this](const Class& of, const Member& member) { create_world(of, member); }}
    , events_{context, registry, sessions}
    , admission_{context, registry, events_, host, services_} {}

void ClassRequests::begin() {
    for (const auto& [name, of] : registry_.classes()) {
        actions_.set_class(name, rules_of(of), base::server_actor(), [](const auto&) {});
    }
}

void ClassRequests::handle(Session& session, const v1::Request& request) {
    const std::uint64_t id = request.request_id();
    if (const auto unknown = protocol::unknown_field_of(request)) {
        return session.answer(protocol::refusing(
            id, {.code = RefusalCode::Unimplemented,
                 .message = "this server does not know a field of the request: it may be older than the client",
                 .violations = {{*unknown, "fields of this server's version; Describe lists them", "an unknown field"}},
                 .reason = Reason::FieldUnknown}));
    }
    const auto answer = [&](Answer answered) {
        session.answer(answered ? *std::move(answered) : protocol::refusing(id, answered.error()));
    };
    switch (request.kind_case()) {
    case v1::Request::kCreateClass:
        return create(session, request);
    case v1::Request::kUpdateClass:
        return update(session, request);
    case v1::Request::kDeleteClass:
        return erase(session, request);
    case v1::Request::kAddMembers:
        return answer(add_members(session, request));
    case v1::Request::kChangeMember:
        return answer(change_member(session, request));
    case v1::Request::kMakeQrCodes:
        return make_qr_codes(session, request);
    default:
        return answer(list(session, id));
    }
}

void ClassRequests::forget(const Session& session) {
    if (session.greeted() && session.user().is_member) {
        const std::string& user = session.user().name;
        events_.changed(user.substr(0, user.find('/')));
    }
}

// ---- classes -----------------------------------------------------------------------------------------------------

Result<Class> ClassRequests::checked(const v1::CreateClass& given, const std::string& teacher) const {
    Violations violations;
    Class of{.name = given.name(), .teacher = teacher, .world_template = {}};
    if (!classes::is_class_name(given.name())) {
        violations.push_back({"create_class.name", std::string{classes::class_name_allowed}, '"' + given.name() + '"'});
    }
    if (!v1::ClassSeeds_IsValid(given.seeds())) {
        violations.push_back({"create_class.seeds", "a value of ClassSeeds", std::to_string(given.seeds())});
    }
    of.own_seeds = given.seeds() == v1::CLASS_SEEDS_OWN;
    of.ranges = classes::ranges_of(given.ranges(), "create_class.ranges", violations);
    if (given.member_worlds_max() != 0) {
        check_worlds_max(given.member_worlds_max(), "create_class.member_worlds_max", violations);
        of.member_worlds_max = given.member_worlds_max();
    }
    check_lesson(given.lesson(), "create_class.lesson", violations);
    of.lesson = given.lesson();
    of.world_template = template_of(given.template_(), of, violations);
    if (!violations.empty()) {
        return protocol::invalid(std::move(violations));
    }
    if (classes::find(registry_.classes(), of.name) != nullptr) {
        return base::Refusal{.code = RefusalCode::AlreadyExists,
                             .message = "there is a class \"" + of.name + "\" already: choose another name",
                             .violations = {},
                             .reason = Reason::ClassExists,
                             .arguments = {{"class", of.name}}};
    }
    return of;
}

void ClassRequests::create(Session& session, const v1::Request& request) {
    const std::uint64_t id = request.request_id();
    auto of = checked(request.create_class(), session.user().name);
    if (!of) {
        return session.answer(protocol::refusing(id, of.error()));
    }
    classes::open(*of, true, registry_.classes(), services_.now_s(), services_.draw);
    if (auto stored = registry_.store(*of); !stored) {
        return session.answer(protocol::refusing(id, stored.error()));
    }
    log::info({.session = session.number(), .client = session.by()}, "session {}: {} creates class {}",
              session.number(), session.by(), of->name);
    events_.changed(of->name);
    actions_.set_class(of->name, rules_of(*of), session.actor(),
                       [this, id, of = *of, weak = session.weak_from_this()](const std::vector<std::string>& worlds) {
                           // Worlds of a class of this name that was deleted while the server was killed. No member of
                           // the new class may get one of them.
                           delete_worlds(worlds);
                           if (const SessionPtr waiting = weak.lock()) {
                               waiting->answer(answer_of(id, info_of(of)));
                           }
                       });
}

void ClassRequests::update(Session& session, const v1::Request& request) {
    const std::uint64_t id = request.request_id();
    const v1::UpdateClass& given = request.update_class();
    const auto there = managed(session, given.class_(), "update_class.class");
    if (!there) {
        return session.answer(protocol::refusing(id, there.error()));
    }
    Class next = **there;
    Violations violations;
    if (given.new_code() && given.has_open() && !given.open()) {
        violations.push_back({"update_class.new_code", "false if open is false", "true"});
    }
    if (given.has_ranges()) {
        next.ranges = classes::ranges_of(given.ranges(), "update_class.ranges", violations);
    }
    if (given.has_member_worlds_max()) {
        check_worlds_max(given.member_worlds_max(), "update_class.member_worlds_max", violations);
        next.member_worlds_max = given.member_worlds_max();
    }
    check_lesson(given.lesson(), "update_class.lesson", violations);
    if (!violations.empty()) {
        return session.answer(protocol::refusing(id, protocol::invalid(std::move(violations))));
    }
    next.lesson = given.has_lesson() ? given.lesson() : next.lesson;
    next.frozen = given.has_frozen() ? given.frozen() : next.frozen;
    if (given.has_open() && !given.open()) {
        next.code.reset();
    } else if (given.open() || given.new_code()) {
        classes::open(next, given.new_code(), registry_.classes(), services_.now_s(), services_.draw);
    }
    if (auto stored = registry_.store(next); !stored) {
        return session.answer(protocol::refusing(id, stored.error()));
    }
    events_.changed(next.name);
    actions_.set_class(next.name, rules_of(next), session.actor(),
                       [this, id, name = next.name, weak = session.weak_from_this()](const auto&) {
                           const Class* of = classes::find(registry_.classes(), name);
                           if (const SessionPtr waiting = weak.lock()) {
                               waiting->answer(of != nullptr ? answer_of(id, info_of(*of)) : response_to(id));
                           }
                       });
}

void ClassRequests::erase(Session& session, const v1::Request& request) {
    const std::uint64_t id = request.request_id();
    const auto there = managed(session, request.delete_class().class_(), "delete_class.class");
    if (!there) {
        return session.answer(protocol::refusing(id, there.error()));
    }
    // The members cannot connect while their worlds are deleted, so that no world is created again. If the server is
    // killed now, the class is still there, and its teacher can delete it again.
    Class ending = **there;
    ending.code.reset();
    for (Member& member : ending.members) {
        member.removed = true;
    }
    const std::string name = ending.name;
    if (auto stored = registry_.store(std::move(ending)); !stored) {
        return session.answer(protocol::refusing(id, stored.error()));
    }
    end_sessions(name + "/", refusal(RefusalCode::Unauthenticated, "your teacher has deleted the class",
                                     Reason::MemberRemoved, {{"class", name}}));
    actions_.set_class(name, std::nullopt, session.actor(),
                       [this, id, name, weak = session.weak_from_this()](const std::vector<std::string>& worlds) {
                           for (const std::string& world : worlds) {
                               v1::Request command;
                               command.mutable_delete_world()->set_world(world);
                               actions_.send(std::move(command));
                           }
                           const Class* last = classes::find(registry_.classes(), name);
                           const std::optional<Class> before = last != nullptr ? std::optional{*last} : std::nullopt;
                           const auto erased = registry_.erase(name);
                           if (erased && before) {
                               events_.deleted(*before);
                           }
                           if (const SessionPtr waiting = weak.lock()) {
                               waiting->answer(erased ? response_to(id) : protocol::refusing(id, erased.error()));
                           }
                       });
}

v1::Response ClassRequests::list(const Session& session, std::uint64_t request_id) const {
    v1::Response response = response_to(request_id);
    v1::ClassList& all = *response.mutable_classes();
    for (const auto& [name, of] : registry_.classes()) {
        if (may_manage(session, of)) {
            *all.add_classes() = info_of(of);
        }
    }
    return response;
}

// ---- members -----------------------------------------------------------------------------------------------------

ClassRequests::Answer ClassRequests::add_members(const Session& session, const v1::Request& request) {
    const v1::AddMembers& given = request.add_members();
    const auto there = managed(session, given.class_(), "add_members.class");
    if (!there) {
        return there.error();
    }
    if (given.names_size() < 1 || static_cast<std::size_t>(given.names_size()) > classes::members_max) {
        return protocol::invalid({{"add_members.names", "1 to " + std::to_string(classes::members_max) + " names",
                                   std::to_string(given.names_size()) + " names"}});
    }
    Class next = **there;
    v1::Response response = response_to(request.request_id());
    for (int i = 0; i < given.names_size(); ++i) {
        const auto member =
            classes::add_member(next, given.names(i), "add_members.names[" + std::to_string(i) + "]", services_.draw);
        if (!member) {
            return member.error();
        }
        v1::PersonalCode& code = *response.mutable_personal_codes()->add_codes();
        code.set_number((*member)->number);
        code.set_name((*member)->name);
        code.set_code(classes::renew_personal_code(**member, services_.draw));
    }
    events_.changed(next.name);
    if (auto stored = registry_.store(std::move(next)); !stored) {
        return stored.error();
    }
    return response;
}

ClassRequests::Answer ClassRequests::change_member(const Session& session, const v1::Request& request) {
    const v1::ChangeMember& given = request.change_member();
    const auto there = managed(session, given.class_(), "change_member.class");
    if (!there) {
        return there.error();
    }
    Class next = **there;
    Member* const member = classes::find(next, given.number());
    if (member == nullptr) {
        return base::Refusal{.code = RefusalCode::NotFound,
                             .message = "the class has no member with this number",
                             .violations = {{"change_member.number", "the number of a member, as in ListClasses",
                                             std::to_string(given.number())}},
                             .reason = Reason::MemberNotFound,
                             .arguments = {{"class", next.name}}};
    }
    if (given.has_name()) {
        if (auto renamed = classes::rename(next, *member, given.name(), "change_member.name"); !renamed) {
            return renamed.error();
        }
    }
    const bool is_kicked = given.has_removed() && given.removed() && !member->removed;
    member->removed = given.has_removed() ? given.removed() : member->removed;
    v1::Response response = response_to(request.request_id());
    v1::PersonalCode& code = *response.mutable_personal_codes()->add_codes();
    if (given.new_personal_code()) {
        member->tokens.clear();
        code.set_code(classes::renew_personal_code(*member, services_.draw));
    }
    code.set_number(member->number);
    code.set_name(member->name);
    const std::string user = classes::user_of(next, *member), name = next.name;
    if (auto stored = registry_.store(std::move(next)); !stored) {
        return stored.error();
    }
    if (is_kicked) {
        end_sessions(user, removed_refusal(name));
    } else if (given.new_personal_code()) {
        end_sessions(user, refusal(RefusalCode::Unauthenticated,
                                   "your teacher has made a new personal code for you: connect with it",
                                   Reason::TokenRevoked, {{"class", name}}));
    }
    events_.changed(name);
    return response;
}

void ClassRequests::make_qr_codes(Session& session, const v1::Request& request) {
    const std::uint64_t id = request.request_id();
    const auto& texts = request.make_qr_codes().texts();
    const auto refused = [&](const std::string& field, const std::string& allowed, const std::string& got) {
        session.answer(protocol::refusing(id, protocol::invalid({{field, allowed, got}})));
    };
    if (texts.empty() || static_cast<std::size_t>(texts.size()) > qr_codes_max) {
        return refused("make_qr_codes.texts", "1 to " + std::to_string(qr_codes_max) + " texts",
                       std::to_string(texts.size()) + " texts");
    }
    for (int i = 0; i < texts.size(); ++i) {
        if (texts[i].empty() || texts[i].size() > classes::qr_text_bytes_max) {
            return refused("make_qr_codes.texts[" + std::to_string(i) + "]",
                           "1 to " + std::to_string(classes::qr_text_bytes_max) + " bytes",
                           std::to_string(texts[i].size()) + " bytes");
        }
    }
    struct Work {
        std::weak_ptr<Session> session;
        v1::Request request;
        v1::Response response;
    };
    const auto work = std::make_shared<Work>(Work{session.weak_from_this(), request, response_to(id)});
    // Each step posts the next one, so that others are served between two codes.
    const auto step = [this, work](const auto& self) -> void {
        const SessionPtr waiting = work->session.lock();
        if (!waiting) {
            return;
        }
        v1::QrCodes& made = *work->response.mutable_qr_codes();
        const auto& wanted = work->request.make_qr_codes().texts();
        const auto code = classes::qr_code_of(wanted[made.codes_size()]);
        if (!code) {
            return waiting->answer(protocol::refusing(
                work->request.request_id(),
                refusal(RefusalCode::ResourceExhausted, "the server has no memory for the codes: try again")));
        }
        v1::QrCode& to = *made.add_codes();
        to.set_size(code->size);
        to.set_modules(code->modules);
        if (made.codes_size() == wanted.size()) {
            return waiting->answer(std::move(work->response));
        }
        asio::post(context_, [self] { self(self); });
    };
    step(step);
}

// ---- helpers -----------------------------------------------------------------------------------------------------

Result<const Class*> ClassRequests::managed(const Session& session, const std::string& name,
                                            const std::string& field) const {
    const Class* of = classes::find(registry_.classes(), name);
    if (of != nullptr && may_manage(session, *of)) {
        return of;
    }
    std::vector<std::string> own;
    for (const auto& [other, that] : registry_.classes()) {
        if (may_manage(session, that)) {
            own.push_back(other);
        }
    }
    return base::Refusal{
        .code = RefusalCode::NotFound,
        .message = own.empty() ? "this user has no class: create one" : "this user has no such class",
        .violations = {{field, "the name of a class of this user" + text::did_you_mean(name, own), '"' + name + '"'}},
        .reason = Reason::ClassNotFound,
        .arguments = {{"class", name}}};
}

std::optional<base::Refusal> ClassRequests::refusal_of(const Session& session, const v1::ForEachWorld& request) const {
    const auto of = managed(session, request.class_(), "for_each_world.class");
    return of ? std::nullopt : std::optional{of.error()};
}

v1::ClassInfo ClassRequests::info_of(const Class& of) const {
    v1::ClassInfo info;
    info.set_name(of.name);
    info.set_teacher(of.teacher);
    if (const std::int64_t now_s = services_.now_s(); classes::is_open(of, now_s)) {
        info.set_code(of.code->letters);
        info.set_code_valid_s(static_cast<std::uint32_t>(std::min(of.code->ends_at_s - now_s, classes::code_valid_s)));
    }
    info.set_frozen(of.frozen);
    info.mutable_template_()->ParseFromString(of.world_template);
    info.set_seeds(of.own_seeds ? v1::CLASS_SEEDS_OWN : v1::CLASS_SEEDS_SAME);
    *info.mutable_ranges() = classes::to_proto(of.ranges);
    info.set_member_worlds_max(of.member_worlds_max);
    info.set_lesson(of.lesson);
    std::map<std::string, std::uint32_t> session_counts;
    for (const auto& [number, session] : sessions_) {
        if (session->greeted() && !session->is_over()) {
            ++session_counts[session->user().name];
        }
    }
    for (const Member& member : of.members) {
        v1::ClassMember& to = *info.add_members();
        to.set_number(member.number);
        to.set_name(member.name);
        to.set_user(classes::user_of(of, member));
        to.set_world(classes::world_of(of, member));
        to.set_sessions(session_counts[to.user()]);
        to.set_removed(member.removed);
        to.set_joined(member.joined);
    }
    info.set_codes_are_guessed(admission_.codes_are_guessed());
    return info;
}

void ClassRequests::create_world(const Class& of, const Member& member) {
    if (actions_.create_world(creation_of(of, member), {classes::user_of(of, member), of.name, of.teacher})) {
        return;
    }
    const auto timer = std::make_shared<asio::steady_timer>(context_, busy_pause);
    timer->async_wait([this, timer, name = of.name, number = member.number](boost::system::error_code error) {
        const Class* now = classes::find(registry_.classes(), name);
        if (now == nullptr || error) {
            return;
        }
        const auto there = std::ranges::find(now->members, number, &Member::number);
        if (there != now->members.end() && !there->removed) {
            create_world(*now, *there);
        }
    });
}

void ClassRequests::delete_worlds(const std::vector<std::string>& worlds) const {
    for (const std::string& world : worlds) {
        v1::Request command;
        command.mutable_delete_world()->set_world(world);
        actions_.send(std::move(command));
    }
}

void ClassRequests::end_sessions(const std::string& user, const base::Refusal& why) const {
    const Sessions sessions = sessions_; // fail() may remove sessions from the table
    for (const auto& [number, session] : sessions) {
        if (session->greeted() && session->user().is_member &&
            (user.ends_with('/') ? session->user().name.starts_with(user) : session->user().name == user)) {
            session->fail(why);
        }
    }
}

} // namespace evod::network
