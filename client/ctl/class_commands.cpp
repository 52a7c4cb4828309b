// evoctl class: creates classes, lets students join, and controls the worlds of a class all together.
#include "client/core/page_link.h"
#include "client/ctl/class_info.h"
#include "client/ctl/class_results.h"
#include "client/ctl/input_file.h"
#include "client/ctl/qr_text.h"
#include "client/ctl/student_list.h"
#include "client/ctl/world_template.h"
#include "proto/command_line/command.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <iostream>
#include <map>
#include <sstream>

namespace evod::ctl {

namespace {

// ---- create ----------------------------------------------------------------------------------------------------

struct ClassOptions {
    std::string name, page;
    bool qr = false; // draw the QR code even if standard output is not a terminal
};

struct CreateClassOptions : ClassOptions {
    std::string experiment, population, students, seeds = "same", lesson;
    std::vector<std::string> ranges, words;
    std::optional<std::uint64_t> seed;
    std::optional<std::uint32_t> worlds_max;
};

/// Parses PARAMETER=MIN..MAX.
v1::QuotaRange range_of(const std::string& word) {
    v1::QuotaRange range;
    const std::size_t equals = word.find('='), dots = word.find("..", std::min(equals, word.size()));
    const auto read = [&](std::size_t begin, std::size_t end) -> std::optional<double> {
        double number = 0;
        const auto done = std::from_chars(word.data() + begin, word.data() + end, number);
        return done.ec == std::errc{} && done.ptr == word.data() + end ? std::optional{number} : std::nullopt;
    };
    if (equals != std::string::npos && dots != std::string::npos) {
        const auto min = read(equals + 1, dots), max = read(dots + 2, word.size());
        if (min && max) {
            range.set_parameter(word.substr(0, equals));
            range.set_min(*min);
            range.set_max(*max);
            return range;
        }
    }
    throw Stop{ExitCode::Usage,
               "--range: got " + word + ", allowed PARAMETER=MIN..MAX, such as population_size=1..500"};
}

std::vector<ListedStudent> students_in(const std::string& path) {
    constexpr std::size_t list_bytes_max = 1 << 20;
    std::istringstream text{text_in(path, "a list of students", list_bytes_max)};
    auto students = read_students(text);
    if (!students) {
        Mistakes mistakes = students.error();
        for (std::string& line : mistakes.lines) {
            line = "--students: " + path + ", " + line;
        }
        stop_for(mistakes);
    }
    return *std::move(students);
}

/// Shows how to join: the code, the link, and on a terminal the QR code of the link.
std::string invitation(Caller& caller, const ClassOptions& options, const v1::ClassInfo& info) {
    if (info.code().empty()) {
        return "";
    }
    std::string text = "code: " + code_text(info) + "\n";
    if (options.page.empty() && caller.page().empty()) {
        return text + "link: none, because this server has no page; --page names the address of another\n";
    }
    const std::string link = join_link(caller, options.page, info.code());
    if (core::is_of_this_machine(link)) {
        std::cerr << "evoctl: other devices cannot use this link: name the address of this machine with --page\n";
    }
    return text + "link: " + link + "\n";
}

/// Draws the QR code of the link. It must not pass print(), which would remove its colours.
void draw_code(const Common& common, Caller& caller, const ClassOptions& options, const v1::ClassInfo& info) {
    const bool has_link = !info.code().empty() && !(options.page.empty() && caller.page().empty());
    if (common.json || !has_link || !(options.qr || on_terminal())) {
        return;
    }
    v1::Request request;
    request.mutable_make_qr_codes()->add_texts(join_link(caller, options.page, info.code()));
    const v1::Response response = caller.call(std::move(request));
    for (const v1::QrCode& code : response.qr_codes().codes()) {
        std::cout << std::flush;
        const std::string text = qr_text(code, on_terminal());
        std::fwrite(text.data(), 1, text.size(), stdout);
    }
}

void show_class(const Common& common, Caller& caller, const ClassOptions& options, const v1::ClassInfo& info) {
    print(common, info, [&] {
        std::string text = class_text(info);
        const std::string link = invitation(caller, options, info);
        return link.empty() ? text : text + link.substr(link.find('\n') + 1);
    });
    draw_code(common, caller, options, info);
}

/// Prints personal codes as a list, which a teacher prints or cuts into slips.
std::string codes_text(const Caller& caller, const std::string& page, const v1::PersonalCodes& codes) {
    Table table{{{"NUMBER", Table::Align::Right}, {"NAME"}, {"CODE"}, {"LINK"}}};
    const bool has_page = !page.empty() || !caller.page().empty();
    for (const v1::PersonalCode& code : codes.codes()) {
        table.add({std::to_string(code.number()), code.name(), code.code(),
                   has_page ? join_link(caller, page, code.code()) : ""});
    }
    return table.to_text();
}

v1::CreateClass class_of(Caller& caller, const CreateClassOptions& options) {
    v1::CreateClass wanted;
    wanted.set_name(options.name);
    v1::CreateWorld& world = *wanted.mutable_template_();
    if (!options.experiment.empty()) {
        add_experiment(options.experiment, world);
    }
    if (!options.population.empty()) {
        add_population(options.population, world);
    }
    if (!options.words.empty()) {
        const auto assignments = caller.registry().assignments(options.words);
        if (!assignments) {
            stop_for(assignments.error());
        }
        world.mutable_parameters()->Assign(assignments->begin(), assignments->end());
    }
    if (options.seed) {
        world.set_seed(*options.seed);
    }
    wanted.set_seeds(options.seeds == "own" ? v1::CLASS_SEEDS_OWN : v1::CLASS_SEEDS_SAME);
    for (const std::string& word : options.ranges) {
        *wanted.mutable_ranges()->add_ranges() = range_of(word);
    }
    wanted.set_member_worlds_max(options.worlds_max.value_or(0));
    wanted.set_lesson(options.lesson);
    return wanted;
}

/// Adds the members of a list. If the server refuses one, deletes the class, and names the line of each refused name.
v1::PersonalCodes add_students(Caller& caller, const CreateClassOptions& options,
                               const std::vector<ListedStudent>& students) {
    v1::Request request;
    request.mutable_add_members()->set_class_(options.name);
    for (const ListedStudent& student : students) {
        request.mutable_add_members()->add_names(student.name);
    }
    try {
        return caller.call(std::move(request)).personal_codes();
    } catch (const Stop& stop) {
        v1::Request undo;
        undo.mutable_delete_class()->set_class_(options.name);
        caller.call(std::move(undo));
        Mistakes mistakes;
        for (const v1::Violation& violation : stop.status.violations()) {
            std::size_t index = 0;
            const std::string_view field = violation.field();
            const std::size_t at = field.find('[');
            if (at != std::string_view::npos &&
                std::from_chars(field.data() + at + 1, field.data() + field.size(), index).ec == std::errc{} &&
                index < students.size()) {
                mistakes.lines.push_back("--students: " + options.students + ", line " +
                                         std::to_string(students[index].line) + ": got " + violation.got() +
                                         ", allowed " + violation.allowed());
            }
        }
        if (!mistakes.lines.empty()) {
            stop_for(mistakes);
        }
        throw;
    }
}

void create_class(const Common& common, const CreateClassOptions& options) {
    std::vector<ListedStudent> students;
    if (!options.students.empty()) {
        students = students_in(options.students);
    }
    Caller caller{common};
    v1::Request request;
    *request.mutable_create_class() = class_of(caller, options);
    v1::Response response = caller.call(std::move(request));
    if (students.empty()) {
        print(common, response.class_info(), [&] {
            return "created class " + options.name + "\n" + invitation(caller, options, response.class_info());
        });
        draw_code(common, caller, options, response.class_info());
        return;
    }
    const v1::PersonalCodes codes = add_students(caller, options, students);
    print(common, codes, [&] {
        return "created class " + options.name + " with " + std::to_string(codes.codes_size()) +
               " members; their codes cannot be shown again\n" + codes_text(caller, options.page, codes);
    });
}

// ---- the class -------------------------------------------------------------------------------------------------

void list_classes(const Common& common) {
    Caller caller{common};
    v1::Request request;
    request.mutable_list_classes();
    const v1::ClassList list = caller.call(std::move(request)).classes();
    print(common, list, [&] {
        Table table{{{"CLASS"}, {"TEACHER"}, {"MEMBERS", Table::Align::Right}, {"CODE"}, {"STATE"}, {"LESSON"}}};
        for (const v1::ClassInfo& info : list.classes()) {
            table.add({info.name(), info.teacher(), std::to_string(info.members_size()),
                       info.code().empty() ? "-" : info.code(),
                       info.frozen()         ? "frozen"
                       : info.code().empty() ? "locked"
                                             : "open",
                       info.lesson()});
        }
        return list.classes().empty() ? std::string{"no classes: create one with `evoctl class create NAME`\n"}
                                      : table.to_text();
    });
}

/// Changes a class, and returns its new state.
v1::ClassInfo update(Caller& caller, v1::UpdateClass wanted) {
    v1::Request request;
    *request.mutable_update_class() = std::move(wanted);
    return caller.call(std::move(request)).class_info();
}

void open_class(const Common& common, const ClassOptions& options, bool open, bool new_code) {
    Caller caller{common};
    v1::UpdateClass wanted;
    wanted.set_class_(options.name);
    wanted.set_open(open);
    wanted.set_new_code(new_code);
    const v1::ClassInfo info = update(caller, wanted);
    print(common, info, [&] {
        return open ? invitation(caller, options, info) : "no student can join " + options.name + " any more\n";
    });
    draw_code(common, caller, options, info);
}

/// Applies an action to every world of a class, and reports each world that refuses it.
void for_each(const Common& common, Caller& caller, const std::string& name, v1::ForEachWorld action,
              const std::string& done) {
    action.set_class_(name);
    v1::Request request;
    *request.mutable_for_each_world() = std::move(action);
    const v1::WorldResults results = caller.call(std::move(request)).world_results();
    const auto refused = std::ranges::count_if(results.results(), &v1::WorldResult::has_status);
    print(common, results, [&] {
        const auto count = results.results_size() - refused;
        return done + ": " + std::to_string(count) + (count == 1 ? " world" : " worlds") + " of " + name + "\n";
    });
    std::string text;
    for (const v1::WorldResult& result : results.results()) {
        if (result.has_status()) {
            text += (text.empty() ? "" : "\n") + result.world() + ": " + core::to_text(result.status());
        }
    }
    if (!text.empty()) {
        throw Stop{ExitCode::Refused, text};
    }
}

void freeze(const Common& common, const std::string& name, bool frozen) {
    Caller caller{common};
    if (!frozen && !class_named(caller, name).frozen()) { // then its worlds may be paused
        v1::ForEachWorld action;
        action.mutable_resume();
        return for_each(common, caller, name, action, "resumed");
    }
    v1::UpdateClass wanted;
    wanted.set_class_(name);
    wanted.set_frozen(frozen);
    const v1::ClassInfo info = update(caller, wanted);
    print(common, info, [&] { return name + (frozen ? " is frozen\n" : " goes on\n"); });
}

struct MemberOptions {
    std::string name, member, new_name;
};

void change_member(const Common& common, const MemberOptions& options, v1::ChangeMember wanted,
                   const std::string& done) {
    Caller caller{common};
    const v1::ClassInfo info = class_named(caller, options.name);
    const v1::ClassMember& member = member_named(info, options.member);
    wanted.set_class_(options.name);
    wanted.set_number(member.number());
    v1::Request request;
    *request.mutable_change_member() = std::move(wanted);
    const v1::Response response = caller.call(std::move(request));
    print(common, response.personal_codes(), [&] { return member.name() + " " + done + "\n"; });
}

struct SheetOptions : ClassOptions {
    std::vector<std::string> members;
};

/// Makes new personal codes: of the named members, otherwise of those who have not joined yet.
void print_sheet(const Common& common, const SheetOptions& options) {
    Caller caller{common};
    const v1::ClassInfo info = class_named(caller, options.name);
    std::vector<const v1::ClassMember*> wanted;
    for (const std::string& word : options.members) {
        wanted.push_back(&member_named(info, word));
    }
    if (options.members.empty()) {
        for (const v1::ClassMember& member : info.members()) {
            if (!member.joined() && !member.removed()) {
                wanted.push_back(&member);
            }
        }
    }
    if (wanted.empty()) {
        throw Stop{ExitCode::Refused, "every member of " + options.name +
                                          " has joined already: name those who need a new code, "
                                          "which ends their sessions"};
    }
    v1::PersonalCodes codes;
    for (const v1::ClassMember* member : wanted) {
        v1::Request request;
        request.mutable_change_member()->set_class_(options.name);
        request.mutable_change_member()->set_number(member->number());
        request.mutable_change_member()->set_new_personal_code(true);
        codes.MergeFrom(caller.call(std::move(request)).personal_codes());
    }
    print(common, codes, [&] { return codes_text(caller, options.page, codes); });
}

void delete_class(const Common& common, const std::string& name) {
    Caller caller{common};
    v1::Request request;
    request.mutable_delete_class()->set_class_(name);
    const v1::Response response = caller.call(std::move(request));
    print(common, response, [&] { return "deleted class " + name + " and its worlds; their run files stay\n"; });
}

// ---- the command line ------------------------------------------------------------------------------------------

void add_name(command_line::Command& command, std::string& name) {
    command.add_option("NAME", &name, "Name of the class").required();
}

void add_link_options(command_line::Command& command, ClassOptions& options, bool has_qr = true) {
    command.add_option("--page", &options.page,
                       "Address of the page, for example of a proxy; default: the one that the server reports");
    if (has_qr) {
        command.add_flag("--qr", &options.qr, "Draw the QR code even if standard output is not a terminal");
    }
}

void add_create(command_line::Command& classes, const Common& common) {
    auto& command = classes.add_command("create", "Create a class; students can join at once");
    auto& options = command.keep(CreateClassOptions{});
    command
        .add_option("NAME", &options.name,
                    "Name of the class: 1 to 24 characters of a-z 0-9 -, beginning with a letter")
        .required();
    command.add_option("--experiment", &options.experiment,
                       "JSON file of parameters and optionally a seed, for the world of each member");
    command.add_option("--population", &options.population,
                       "CSV file with the first population, from `evod export --what population`");
    command.add_option("--set", &options.words,
                       "Parameters as NAME=VALUE; all others are those of --experiment, or the defaults");
    command
        .add_option("--seed", &options.seed,
                    "Seed of the worlds; default: the seed in the --experiment file, otherwise a random seed")
        .check(whole_number);
    command.add_option("--seeds", &options.seeds, "same: equal seeds; own: each member has another seed")
        .choices({"same", "own"})
        .show_default();
    command.add_option("--range", &options.ranges,
                       "Narrower ranges of parameters in these worlds, each as PARAMETER=MIN..MAX; default: those that "
                       "the server has for classes");
    command
        .add_option("--worlds-max", &options.worlds_max, "Largest number of worlds of one member, 1 to 8; default: 3")
        .check(command_line::WholeNumber{.min = 1, .max = 8});
    command.add_option("--lesson", &options.lesson, "Name of the lesson that the page of each member opens");
    command.add_option(
        "--students", &options.students,
        "CSV file with a name in the first cell of each row: creates these members, and prints a personal "
        "code for each");
    add_link_options(command, options);
    command.footer("Examples:\n  evoctl class create bio2 --experiment lesson.json --range population_size=1..200\n"
                   "  evoctl class create bio2 --students list.csv > codes.txt");
    command.action([&] { create_class(common, options); });
}

void add_state_commands(command_line::Command& classes, const Common& common) {
    classes.add_command("list", "List your classes").action([&] { list_classes(common); });

    struct Act {
        const char *name, *help;
        void (*act)(const Common&, const ClassOptions&);
    };
    static constexpr Act acts[] = {
        {"show", "Show a class: its code, its link, its members",
         [](const Common& common, const ClassOptions& options) {
             Caller caller{common};
             show_class(common, caller, options, class_named(caller, options.name));
         }},
        {"open", "Let students join for 20 minutes, and show the code and the link",
         [](const Common& common, const ClassOptions& options) { open_class(common, options, true, false); }},
        {"code", "Replace the code, and show the new one and its link",
         [](const Common& common, const ClassOptions& options) { open_class(common, options, true, true); }},
    };
    for (const Act& act : acts) {
        auto& command = classes.add_command(act.name, act.help);
        auto& options = command.keep(ClassOptions{});
        add_name(command, options.name);
        add_link_options(command, options);
        command.action([&options, &common, act = act.act] { act(common, options); });
    }

    struct Change {
        const char *name, *help;
        void (*act)(const Common&, const std::string&);
    };
    static constexpr Change changes[] = {
        {"lock", "End the code, so that no student can join; members stay",
         [](const Common& common, const std::string& name) {
             open_class(common, {.name = name, .page = {}}, false, false);
         }},
        {"freeze", "Stop all worlds of a class at once; members cannot change them",
         [](const Common& common, const std::string& name) { freeze(common, name, true); }},
        {"resume", "Let the worlds of a class go on after freeze or pause",
         [](const Common& common, const std::string& name) { freeze(common, name, false); }},
        {"delete", "Delete a class and its worlds; the run files stay in the server's data folder", delete_class},
    };
    for (const Change& change : changes) {
        auto& command = classes.add_command(change.name, change.help);
        auto& name = command.keep(std::string{});
        add_name(command, name);
        command.action([&name, &common, act = change.act] { act(common, name); });
    }
}

void add_for_each_commands(command_line::Command& classes, const Common& common) {
    struct Options {
        std::string name, speed;
        std::vector<std::string> words;
        std::optional<std::uint64_t> generations, seed;
    };
    const auto add = [&](const char* name, const char* help) -> std::pair<command_line::Command&, Options&> {
        auto& command = classes.add_command(name, help);
        auto& options = command.keep(Options{});
        add_name(command, options.name);
        return {command, options};
    };
    {
        auto [command, options] = add("set", "Change parameters in all worlds of a class at once");
        command.add_option("CHANGE", &options.words, "Parameters with their new values, each as NAME=VALUE").required();
        command.action([&common, &options = options] {
            Caller caller{common};
            const auto assignments = caller.registry().assignments(options.words);
            if (!assignments) {
                stop_for(assignments.error());
            }
            v1::ForEachWorld action;
            action.mutable_set_parameters()->mutable_parameters()->Assign(assignments->begin(), assignments->end());
            for_each(common, caller, options.name, action, "changed");
        });
    }
    {
        auto [command, options] = add("run", "Run N more generations in all worlds of a class, or until paused");
        command.add_option("N", &options.generations, "Number of generations; default: until the worlds are paused")
            .check(at_least_one);
        command.action([&common, &options = options] {
            Caller caller{common};
            v1::ForEachWorld action;
            action.mutable_run();
            if (options.generations) {
                action.mutable_run()->set_generations(*options.generations);
            }
            for_each(common, caller, options.name, action, "started");
        });
    }
    {
        auto [command, options] = add("pause", "Pause all worlds of a class; members can go on themselves");
        command.action([&common, &options = options] {
            Caller caller{common};
            v1::ForEachWorld action;
            action.mutable_pause();
            for_each(common, caller, options.name, action, "paused");
        });
    }
    {
        auto [command, options] = add("speed", "Set the speed of all worlds of a class");
        command.add_option("SPEED", &options.speed, "Simulated seconds per second of real time, 0.001 to 10000, or max")
            .required();
        command.action([&common, &options = options] {
            v1::ForEachWorld action;
            *action.mutable_set_speed()->mutable_speed() = parse_speed(options.speed);
            Caller caller{common};
            for_each(common, caller, options.name, action, "speed set");
        });
    }
    {
        auto [command, options] = add("reset", "Start the first world of every member again at generation 1");
        command.add_option("--seed", &options.seed, "Seed of the new runs; default: the seed of each world")
            .check(whole_number);
        command.action([&common, &options = options] {
            Caller caller{common};
            v1::ForEachWorld action;
            action.mutable_reset_world();
            if (options.seed) {
                action.mutable_reset_world()->set_seed(*options.seed);
            }
            for_each(common, caller, options.name, action, "reset");
        });
    }
}

void add_member_commands(command_line::Command& classes, const Common& common) {
    const auto add = [&](const char* name, const char* help) -> std::pair<command_line::Command&, MemberOptions&> {
        auto& command = classes.add_command(name, help);
        auto& options = command.keep(MemberOptions{});
        add_name(command, options.name);
        command.add_option("MEMBER", &options.member, "Name or number of the member").required();
        return {command, options};
    };
    {
        auto [command, options] = add("kick", "Remove a member, whose sessions end; the world stays");
        command.action([&common, &options = options] {
            v1::ChangeMember wanted;
            wanted.set_removed(true);
            change_member(common, options, wanted, "is removed");
        });
    }
    {
        auto [command, options] = add("readmit", "Let a removed member in again");
        command.action([&common, &options = options] {
            v1::ChangeMember wanted;
            wanted.set_removed(false);
            change_member(common, options, wanted, "is a member again");
        });
    }
    {
        auto [command, options] = add("rename", "Change the name of a member; user and world keep theirs");
        command.add_option("NEW", &options.new_name, "The new name, 1 to 24 characters").required();
        command.action([&common, &options = options] {
            v1::ChangeMember wanted;
            wanted.set_name(options.new_name);
            change_member(common, options, wanted, "is now " + options.new_name);
        });
    }
    auto& sheet = classes.add_command("sheet", "Make new personal codes, with which members join on any device");
    auto& options = sheet.keep(SheetOptions{});
    add_name(sheet, options.name);
    sheet.add_option("MEMBER", &options.members,
                     "Names or numbers of members, whose sessions end; default: all who have not joined yet");
    add_link_options(sheet, options, false);
    sheet.action([&] { print_sheet(common, options); });
}

void add_result_commands(command_line::Command& classes, const Common& common) {
    auto& compare = classes.add_command("compare", "Compare the worlds of the members");
    auto& compared = compare.keep(CompareOptions{});
    add_name(compare, compared.name);
    compare.add_flag("--csv", &compared.csv, "Comma-separated values: one row per member, generation and island");
    compare.add_flag("--summary", &compared.summary, "With --csv: one row per member");
    compare.footer("Examples:\n  evoctl class compare bio2\n  evoctl class compare bio2 --csv > bio2.csv");
    compare.action([&] { compare_class(common, compared); });

    auto& collect = classes.add_command("collect", "Write the run files, notes and results of a class into a folder");
    auto& collected = collect.keep(CollectOptions{});
    add_name(collect, collected.name);
    collect.add_option("FOLDER", &collected.folder, "Folder; it is created if it does not exist").required();
    collect.footer("The folder contains WORLD.evod for each world, notes.csv with all notes, and students.csv with one "
                   "row per member.\nExample:\n  evoctl class collect bio2 bio2-monday && evod verify "
                   "bio2-monday/*.evod");
    collect.action([&] { collect_class(common, collected); });
}

struct NoteOptions {
    std::string text, kind = "note";
};

} // namespace

void add_class_commands(command_line::Command& app, const Common& common) {
    auto& classes = app.add_command("class", "Lead a class, whose students have a world each").group("Classes");
    add_create(classes, common);
    add_state_commands(classes, common);
    add_for_each_commands(classes, common);
    add_member_commands(classes, common);
    add_result_commands(classes, common);
}

void add_note_command(command_line::Command& app, const Common& common) {
    auto& command = app.add_command("note", "Write a note into the journal of a world").group("Run");
    auto& options = command.keep(NoteOptions{});
    command.add_option("TEXT", &options.text, "The note, 1 to 4,096 bytes").required();
    command.add_option("--kind", &options.kind, "Kind of the note: 1 to 32 characters of a-z 0-9 _").show_default();
    command.footer("Example:\n  evoctl note \"I expect more food to change nothing\" --kind prediction\n"
                   "  evoctl export --what notes");
    command.action([&] {
        Caller caller{common};
        v1::Request request;
        request.mutable_add_note()->set_world(common.world);
        request.mutable_add_note()->set_kind(options.kind);
        request.mutable_add_note()->set_text(options.text);
        const v1::Response response = caller.call(std::move(request));
        print(common, response, [&] {
            return "noted after tick " + std::to_string(response.applied_tick()) + " of " + response.world().name() +
                   "\n";
        });
    });
}

} // namespace evod::ctl
