#include "server/protocol/event_text.h"

#include <boost/json.hpp>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace evod::protocol {
namespace {

struct Example {
    v1::Event event;
    std::string text;
};

/// Reads proto/vectors/events.json, which the test of the browser page reads, too.
std::vector<Example> read_examples() {
    std::ifstream file{EVOD_SOURCE_FOLDER + std::string{"/proto/vectors/events.json"}};
    std::stringstream text;
    text << file.rdbuf();
    std::vector<Example> examples;
    const boost::json::value items = boost::json::parse(text.str());
    for (const auto& item : items.as_array()) {
        Example& example = examples.emplace_back();
        example.text = item.at("text").as_string();
        EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(serialize(item.at("event")), &example.event).ok())
            << item;
    }
    return examples;
}

TEST(EventText, IsThatOfTheExamples) {
    for (const Example& example : read_examples()) {
        EXPECT_EQ(event_text(example.event), example.text) << example.event.ShortDebugString();
    }
}

TEST(EventText, ExistsForEachKindOfEvent) {
    std::set<std::string> kinds, shown;
    const auto* oneof = v1::Event::descriptor()->FindOneofByName("kind");
    for (int i = 0; i < oneof->field_count(); ++i) {
        EXPECT_TRUE(has_event_template(oneof->field(i)->name())) << "proto/texts/events.json has no template for it";
        kinds.insert(oneof->field(i)->name());
    }
    for (const Example& example : read_examples()) {
        shown.insert(example.event.GetReflection()->GetOneofFieldDescriptor(example.event, oneof)->name());
    }
    EXPECT_EQ(shown, kinds) << "proto/vectors/events.json has an example of each kind";
}

TEST(EventText, OfAnEmptyEventHasNoBraces) {
    const auto* oneof = v1::Event::descriptor()->FindOneofByName("kind");
    for (int i = 0; i < oneof->field_count(); ++i) {
        v1::Event event;
        event.GetReflection()->MutableMessage(&event, oneof->field(i));
        EXPECT_EQ(event_text(event).find_first_of("{}[]|"), std::string::npos) << event_text(event);
    }
}

TEST(EventText, SaysWhatTheStorageCannotDo) {
    v1::Storage storage;
    storage.set_state(v1::STORAGE_STATE_KEEPS_UP);
    EXPECT_EQ(storage_text(storage), "");
    storage.set_state(v1::STORAGE_STATE_BEHIND);
    storage.set_reason("it is slow");
    EXPECT_EQ(storage_text(storage), "worlds wait for the disk: it is slow");
}

} // namespace
} // namespace evod::protocol
