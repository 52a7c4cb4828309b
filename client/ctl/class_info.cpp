#include "client/ctl/class_info.h"

#include "client/core/page_link.h"
#include "proto/text/suggestion.h"

#include <algorithm>
#include <iostream>

namespace evod::ctl {

v1::ClassInfo class_named(Caller& caller, const std::string& name) {
    v1::Request request;
    request.mutable_list_classes();
    const v1::Response response = caller.call(std::move(request));
    std::vector<std::string> names;
    for (const v1::ClassInfo& info : response.classes().classes()) {
        if (info.name() == name) {
            return info;
        }
        names.push_back(info.name());
    }
    const auto near = text::nearest(name, names);
    throw Stop{ExitCode::Refused,
               "no class has the name " + name + (near.empty() ? "" : "; did you mean " + near.front() + "?")};
}

const v1::ClassMember& member_named(const v1::ClassInfo& info, const std::string& word) {
    const auto found = [&](const auto& is_wanted) { return std::ranges::find_if(info.members(), is_wanted); };
    auto member = found([&](const v1::ClassMember& one) { return one.name() == word; });
    if (member == info.members().end()) {
        member = found([&](const v1::ClassMember& one) { return std::to_string(one.number()) == word; });
    }
    if (member == info.members().end()) {
        std::vector<std::string> names;
        for (const v1::ClassMember& one : info.members()) {
            names.push_back(one.name());
        }
        const auto near = text::nearest(word, names);
        throw Stop{ExitCode::Refused, "the class " + info.name() + " has no member " + word +
                                          (near.empty() ? "" : "; did you mean " + near.front() + "?")};
    }
    return *member;
}

std::string join_link(const Caller& caller, const std::string& page, const std::string& code) {
    const std::string address = page.empty() ? caller.page() : page;
    if (address.empty()) {
        throw Stop{ExitCode::Refused, "this server has no page that this machine can reach: start it with --web and, "
                                      "for other machines, --http-bind; or give the page's address with --page"};
    }
    return address + (address.ends_with('/') ? "" : "/") + "#join=" + code;
}

std::string code_text(const v1::ClassInfo& info) {
    return info.code().empty() ? "-" : info.code() + ", valid for " + duration(info.code_valid_s());
}

std::string class_text(const v1::ClassInfo& info) {
    std::string text = "class " + info.name() + " of " + info.teacher() + (info.frozen() ? ", frozen" : "") +
                       "\ncode: " + (info.code().empty() ? "none, so no student can join" : code_text(info)) + "\n";
    if (!info.lesson().empty()) {
        text += "lesson: " + info.lesson() + "\n";
    }
    if (info.codes_are_guessed()) {
        text += "wrong codes arrive very fast: they may be guesses; evoctl class code makes a new code\n";
    }
    for (const v1::QuotaRange& range : info.ranges().ranges()) {
        text +=
            "range: " + range.parameter() + " " + number_text(range.min()) + " to " + number_text(range.max()) + "\n";
    }
    Table table{{{"NUMBER", Table::Align::Right}, {"NAME"}, {"WORLD"}, {"SESSIONS", Table::Align::Right}, {"STATE"}}};
    for (const v1::ClassMember& member : info.members()) {
        table.add({std::to_string(member.number()), member.name(), member.world(), std::to_string(member.sessions()),
                   member.removed()  ? "removed"
                   : member.joined() ? "joined"
                                     : "not joined yet"});
    }
    return text + (info.members().empty() ? "no members\n" : table.to_text());
}

} // namespace evod::ctl
