#include "server/classes/membership.h"

#include "server/classes/codes.h"
#include "server/classes/names.h"

#include <openssl/crypto.h>

#include <algorithm>
#include <utility>

namespace evod::classes {
namespace {

using base::Reason;
using base::RefusalCode;
using base::Result;

bool same(const Digest& a, const Digest& b) {
    return CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

/// Finds the member one of whose digests equals `digest`.
///
/// is_one  whether one of a member's digests is equal.
template <class IsOne>
std::optional<Found> find_member(const Classes& classes, const IsOne& is_one) {
    std::optional<Found> found;
    for (const auto& [name, of] : classes) {
        for (const Member& member : of.members) {
            if (is_one(member)) {
                found = {&of, &member};
            }
        }
    }
    return found;
}

bool is_taken(const Class& of, const std::string& name, const Member* except) {
    const std::string wanted = folded(name);
    return std::ranges::any_of(of.members,
                               [&](const Member& other) { return &other != except && folded(other.name) == wanted; });
}

base::Refusal taken(const Class& of, const std::string& name, const std::string& field) {
    return {.code = RefusalCode::AlreadyExists,
            .message = "another member of the class has this name: choose another one",
            .violations = {{field, "a name that no member of the class has", name}},
            .reason = Reason::MemberNameTaken,
            .arguments = {{"class", of.name}}};
}

std::string unused_slug(const Class& of, const std::string& name) {
    const std::string slug = slug_of(name);
    std::string unused = slug;
    for (int number = 2; std::ranges::any_of(of.members, [&](const Member& other) { return other.slug == unused; });
         ++number) {
        unused = slug + "-" + std::to_string(number);
    }
    return unused;
}

std::string unused_name(const Class& of, const Draw& draw) {
    std::uint64_t number = draw(); // a class has far fewer members than there are names
    while (is_taken(of, made_up_name(number), nullptr)) {
        ++number;
    }
    return made_up_name(number);
}

} // namespace

const Class* find(const Classes& classes, const std::string& name) {
    const auto found = classes.find(name);
    return found == classes.end() ? nullptr : &found->second;
}

Member* find(Class& of, std::uint32_t number) {
    const auto found = std::ranges::find(of.members, number, &Member::number);
    return found == of.members.end() ? nullptr : &*found;
}

std::optional<Found> find_by_token(const Classes& classes, std::string_view token) {
    const Digest digest = access::digest_of(token);
    return find_member(classes, [&](const Member& member) {
        bool is_one = false;
        for (const Digest& of_member : member.tokens) {
            is_one |= same(of_member, digest);
        }
        return is_one;
    });
}

std::optional<Found> find_by_personal_code(const Classes& classes, std::string_view code) {
    const Digest digest = access::digest_of(code);
    return find_member(
        classes, [&](const Member& member) { return member.personal_code && same(*member.personal_code, digest); });
}

const Class* find_by_code(const Classes& classes, std::string_view code, std::int64_t now_s) {
    const Class* found = nullptr;
    for (const auto& [name, of] : classes) {
        if (is_open(of, now_s) && same_code(of.code->letters, code)) {
            found = &of;
        }
    }
    return found;
}

bool is_open(const Class& of, std::int64_t now_s) {
    return of.code && now_s < of.code->ends_at_s;
}

void open(Class& of, bool new_code, const Classes& classes, std::int64_t now_s, const Draw& draw) {
    const auto is_used = [&](const std::string& letters) {
        return std::ranges::any_of(
            classes, [&](const auto& other) { return other.second.code && other.second.code->letters == letters; });
    };
    std::string letters = of.code ? of.code->letters : "";
    if (new_code || !is_open(of, now_s)) {
        do {
            letters = code_of(draw(), class_code_letters);
        } while (is_used(letters));
    }
    of.code = {letters, now_s + code_valid_s};
}

Result<Member*> add_member(Class& of, std::string_view name, const std::string& field, const Draw& draw) {
    auto cleaned = cleaned_member_name(name, field);
    if (!cleaned) {
        return cleaned.error();
    }
    if (of.members.size() >= members_max) {
        base::Refusal full = base::limit_refusal(
            "the class has " + std::to_string(members_max) + " members, as many as a class can have",
            Reason::MembersMax, "class_members_max", of.members.size(), members_max);
        full.arguments.push_back({"class", of.name});
        return full;
    }
    if (cleaned->empty()) {
        *cleaned = unused_name(of, draw);
    } else if (is_taken(of, *cleaned, nullptr)) {
        return taken(of, *cleaned, field);
    }
    std::string slug = unused_slug(of, *cleaned);
    of.members.push_back({.number = ++of.last_number, .name = *std::move(cleaned), .slug = std::move(slug)});
    return &of.members.back();
}

Result<void> rename(Class& of, Member& member, std::string_view name, const std::string& field) {
    auto cleaned = cleaned_member_name(name, field);
    if (!cleaned) {
        return cleaned.error();
    }
    if (cleaned->empty()) {
        base::Refusal empty = refusal(RefusalCode::InvalidArgument, field + ": got nothing, allowed a name");
        empty.violations = {{field, "a name", "nothing"}};
        return empty;
    }
    if (is_taken(of, *cleaned, &member)) {
        return taken(of, *cleaned, field);
    }
    member.name = *std::move(cleaned);
    return {};
}

std::string add_token(Member& member, const Draw& draw) {
    std::string token = "evod_";
    for (int word = 0; word < 4; ++word) {
        const std::uint64_t drawn = draw();
        for (int shift = 60; shift >= 0; shift -= 4) {
            token += "0123456789abcdef"[drawn >> shift & 15];
        }
    }
    if (member.tokens.size() >= member_tokens_max) {
        member.tokens.erase(member.tokens.begin());
    }
    member.tokens.push_back(access::digest_of(token));
    return token;
}

std::string renew_personal_code(Member& member, const Draw& draw) {
    const std::string code = code_of(draw(), personal_code_letters);
    member.personal_code = access::digest_of(code);
    return code;
}

} // namespace evod::classes
